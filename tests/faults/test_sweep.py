"""A run whose result is a table ends with the same table, whatever interrupts it."""

import pytest
from drive import interrupt, kill_job, pause_and_resume

pytestmark = pytest.mark.long

SWEEP = {
    "experiment": "gaits",
    "swimmers": ["worm", "tadpole", "ray"],
    "forms": ["ours"],
    "viscosities": [0.1, 1.0],
    "period": 40,
    "cycles": 1,
}


@pytest.fixture
def result(place):
    """All that people get of a run: its table, as JSON and CSV, and its file."""

    def read(run):
        whole = place.http.get(f"/api/v1/runs/{run}/results").raise_for_status().json()
        table = place.http.get(f"/api/v1/runs/{run}/results.csv").raise_for_status().text
        return whole, table, place.archive(run)

    return read


def test_a_sweep_that_is_killed_and_paused_ends_with_the_same_table(place, result):
    undisturbed, disturbed = place.submit(SWEEP), place.submit(SWEEP)
    interrupt(place, disturbed, [kill_job, pause_and_resume], [0, 1])
    place.wait(disturbed, "finished", seconds=300)
    place.wait(undisturbed, "finished", seconds=300)
    whole, table, file = result(undisturbed)
    assert [row["swimmer"] for row in whole["rows"][::2]] == SWEEP["swimmers"]
    assert result(disturbed) == (whole, table, file)
