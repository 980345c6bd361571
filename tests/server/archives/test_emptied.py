"""Cells that lose their elite without a new one, as places of containers do."""

import pytest
from answers import fields

from microcosmos_server.attempts.claim import claim
from microcosmos_server.core import static_files


def cells_at(api, run_id, **asked):
    found = api.get(f"runs/{run_id}/archive", params=asked).json()
    emptied = dict(zip(found["emptied"], found["emptied_generation"], strict=True))
    return dict(zip(found["cell"], found["fitness"], strict=True)), emptied


@pytest.mark.postgresql
def test_an_emptied_cell_has_no_elite_until_the_next(api, run_id, record, published):
    record(1, {5: 1.0, 3: 2.0}, poses=True)
    record(2, emptied=(5,))
    record(3, {7: 0.5}, emptied=(3,))
    record(4, {5: 4.0}, poses=True)
    assert cells_at(api, run_id, generation=1) == ({3: 2.0, 5: 1.0}, {})
    assert cells_at(api, run_id, generation=2) == ({3: 2.0}, {5: 2})
    assert cells_at(api, run_id, generation=3) == ({7: 0.5}, {3: 3, 5: 2})
    assert cells_at(api, run_id) == ({5: 4.0, 7: 0.5}, {3: 3})
    assert cells_at(api, run_id, after=2, generation=3) == ({7: 0.5}, {3: 3})
    assert cells_at(api, run_id, after=3) == ({5: 4.0}, {})
    url = f"runs/{run_id}/archive"
    assert api.get(url).json()["coverage"] == 4 / 256  # As recorded.
    for generation, there in ((1, True), (2, False), (4, True)):
        asked = {"cells": "5", "generation": generation}
        content = api.get(f"{url}/poses", params=asked).content
        assert bool(content) == there
    history = api.get(f"{url}/history").json()
    assert history["cell"] == [3, 5, 7, 5]
    assert (history["emptied"], history["emptied_generation"]) == ([5, 3], [2, 3])
    events = [data for kind, data in published() if kind == "elites"]
    assert [event["emptied"] for event in events] == [[], [5], [3], []]
    assert [event["cell"] for event in events] == [[5, 3], [], [7], [5]]


@pytest.mark.postgresql
def test_a_rewind_restores_what_was_emptied(api, services, run_id, report, attempt, published):
    attempt.record(report(1, {5: 1.0, 3: 2.0}), 1.0)
    attempt.save(1, b"one")
    attempt.record(report(2, {7: 1.0}, emptied=(5,)), 1.0)
    assert cells_at(api, run_id) == ({3: 2.0, 7: 1.0}, {5: 2})
    again = claim(services, run_id, "worker")
    assert cells_at(api, run_id) == ({3: 2.0, 5: 1.0}, {})
    again.record(report(2, emptied=(3,)), 1.0)
    again.record(report(2, emptied=(3,)), 1.0)  # As after an outage.
    assert cells_at(api, run_id) == ({5: 1.0}, {3: 2})


def test_a_fork_starts_from_elites_that_are_there(api, run_id, record, attempt):
    record(1, {5: 1.0, 3: 2.0})
    record(2, emptied=(5,))
    attempt.finish()
    path, archive = f"runs/{run_id}/fork", api.get(f"runs/{run_id}/archive").json()
    forked = api.post(path, json={"from": {"archive": True}}).json()
    assert forked["spec"]["search"]["initial"] == archive["creature"]
    refused = api.post(path, json={"from": {"cells": [5]}})
    assert fields(refused) == ["from.cells"]
    before = api.post(path, json={"from": {"cells": [5]}, "generation": 1})
    assert before.status_code == 202


@pytest.mark.postgresql
def test_a_share_counts_and_covers_the_elites_that_are_there(
    api, address, run_id, record, tmp_path, monkeypatch
):
    (tmp_path / "dist").mkdir()
    (tmp_path / "dist" / "index.html").write_text("<html><head></head></html>")
    monkeypatch.setattr(static_files, "BUILT", tmp_path / "dist")
    record(1, {5: 9.0, 3: 2.0, 4: 1.0})
    record(2, emptied=(5,))
    share = api.post("shares", json={"run": str(run_id)}).json()
    page = api.get(f"{address}/s/{share['slug']}").text
    assert "An archive of 2 swimmers after 2 generations." in page
    archive = api.get(f"runs/{run_id}/archive").json()
    assert share["cover"] == archive["creature"][0]


def test_an_archive_that_lost_all_its_elites_has_nothing_to_publish(api, run_id, record):
    record(1, {5: 1.0})
    record(2, emptied=(5,))
    assert api.post("shares", json={"run": str(run_id)}).status_code == 409
    assert api.get(f"runs/{run_id}/archive").json()["cell"] == []
