"""Re-projections of a run onto other axes: the route, and the command over a real server."""

import json

import pytest
from answers import detail, errors
from typer.testing import CliRunner

from microcosmos.archive.axes import of_spec
from microcosmos.archive.population import creatures
from microcosmos.archive.reprojection import over
from microcosmos.cli import app
from microcosmos_server.archives import reading

SLOW, FAST = {"speed": 0.01, "turning": 0.1}, {"speed": 0.5, "turning": 5.0}


@pytest.fixture
def evolved(record, run_id):
    """Cell 5 is taken by a fast creature, then by a fitter slow one."""
    record(1, {5: 1.0, 3: 0.5}, measures=FAST)
    record(2, {5: 2.0}, measures=SLOW)
    record(3, {3: 3.0, 9: 1.5}, measures=SLOW | {"speed": 0.02})
    return f"runs/{run_id}/archive"


@pytest.mark.postgresql
def test_a_replaced_creature_is_the_best_of_a_cell_of_other_axes(api, evolved):
    found = api.get(f"{evolved}/reprojection", params={"axes": "speed"}).json()
    assert [axis["bins"] for axis in found["axes"]] == [24] == [found["cells"]]
    assert found["cell"] == [20, 0, 0]
    assert found["fitness"] == [1.0, 2.0, 3.0]
    assert found["elite_generation"] == [1, 2, 3]
    assert found["descriptors"] == [[0.5], pytest.approx([0.01]), pytest.approx([0.02])]
    history = api.get(f"{evolved}/history").json()
    assert set(found["creature"]) < set(history["creature"])
    figures = {"creatures": 5, "elites": 2, "coverage": 2 / 24, "qd_score": 4.0, "best": 3.0}
    assert found["all_time"] == figures
    assert found["present"] == {
        "creatures": 3,
        "elites": 1,
        "coverage": 1 / 24,
        "qd_score": 3.0,
        "best": 3.0,
    }


def test_the_route_gives_the_numbers_of_the_library(api, evolved, spec):
    measures = [one["name"] for one in api.get(evolved).json()["recorded"]]
    history = api.get(f"{evolved}/history", params={"measures": ",".join(measures)}).json()
    given = (history["fitness"], history["elite_generation"], history["measures"])
    for names in (["pc1", "speed"], ["pc1", "pc2"], ["fitness", "turning"]):
        made, learned = over(creatures(history["creature"], *given), names, of_spec(spec))
        asked = {"axes": ",".join(names), "measures": "turning"}
        found = api.get(f"{evolved}/reprojection", params=asked).json()
        assert found["cell"] == made.cells.tolist()
        assert found["all_time"]["qd_score"] == made.qd_score
        assert [one["loadings"] for one in found["components"]] == [c.loadings for c in learned]
        rows = made.creatures.measures["turning"][made.entries]
        assert found["measures"]["turning"] == rows.tolist()


def test_impossible_axes_and_too_long_histories_are_refused(api, evolved, monkeypatch):
    path = f"{evolved}/reprojection"
    (error,) = errors(api.get(path, params={"axes": "speed,beauty"}))
    assert (error["field"], error["got"]) == ("axes", "beauty")
    assert "pc1 to pc9" in error["needed"]
    assert api.get(path).status_code == 422
    for axes in ("", "speed,speed", "pc9"):
        (error,) = errors(api.get(path, params={"axes": axes}))
        assert error["field"] == "axes", axes
        assert "needs `axes`" not in error["reason"]
    monkeypatch.setattr(reading, "HISTORY_ENTRIES", 1)
    assert "has 5 entries" in detail(api.get(path, params={"axes": "speed"}), 422)


def test_the_command_compares_all_creatures_with_the_present_elites(
    address, evolved, run_id, tmp_path, monkeypatch
):
    monkeypatch.setenv("MICROCOSMOS_URL", address)
    table = tmp_path / "elites.csv"

    def command(*options, code=0):
        done = CliRunner().invoke(app, ["reproject", str(run_id)[:8], *options])
        assert done.exit_code == code, done.output
        return done

    command("--axes", "speed,turning", "--bins", "12,3", "--out", str(table))
    header, *lines = table.read_text().splitlines()
    assert header == "cell,bin_speed,bin_turning,creature,generation,fitness,speed,turning"
    assert [line.split(",")[:3] for line in lines] == [["1", "0", "1"], ["32", "10", "2"]]
    found = json.loads(command("--axes", "pca", "--json").stdout)
    assert [one["name"] for one in found["components"]] == ["pc1", "pc2"]
    assert [one["creatures"] for one in found["of"]] == [3, 5]
    assert "got beauty" in command("--axes", "beauty", code=1).stderr
