"""Progress of runs: steering, curves, species and the targets of a folding."""

import base64
from concurrent.futures import ThreadPoolExecutor
from uuid import uuid4

import pytest
from answers import detail

from microcosmos.spec import EXPERIMENTS, targets
from microcosmos_server.runs.submission import submit


def test_a_waiting_run_is_paused_resumed_and_cancelled_at_once(api, run_id, claim_run, waiting):
    assert api.post(f"runs/{run_id}/pause").json()["status"] == "paused"
    assert claim_run() is None
    assert api.post(f"runs/{run_id}/resume").json()["status"] == "queued"
    assert waiting() == [str(run_id)]
    cancelled = api.post(f"runs/{run_id}/cancel").json()
    assert cancelled["status"] == "cancelled"
    assert cancelled["finished_at"]
    assert claim_run() is None


def test_forbidden_actions_are_conflicts_with_a_reason(api, run_id, claim_run):
    refused = detail(api.post(f"runs/{run_id}/resume"), 409)
    assert refused == "Cannot resume this run: it is queued; it must be paused"
    claim_run().finish()
    for action in ("pause", "resume", "cancel"):
        assert "it is finished" in detail(api.post(f"runs/{run_id}/{action}"), 409)
        assert api.post(f"runs/{uuid4()}/{action}").status_code == 404
        assert api.post(f"runs/nonsense/{action}").status_code == 422


def test_progress_is_what_was_recorded(api, run_id, attempt, record):
    assert api.get(f"runs/{run_id}").json()["evaluations_per_second"] is None
    attempt.record_device("a device")
    record(1, seconds=20.0)
    with_compilation = api.get(f"runs/{run_id}").json()["evaluations_per_second"]
    assert with_compilation == 16 / 20
    record(2, seconds=6.0)
    record(3, seconds=2.0)
    run = api.get(f"runs/{run_id}").json()
    assert (run["generation"], run["progress"]) == (3, 3 / run["generations"])
    assert (run["evaluations"], run["evaluations_per_second"]) == (48, 8.0)
    assert run["eta_seconds"] == (run["generations"] - 3) * 16 / 8
    assert (run["sparkline"], run["device"]) == ([10, 20, 30], "a device")
    attempt.finish()
    without_the_first = api.get(f"runs/{run_id}").json()["evaluations_per_second"]
    assert without_the_first == 32 / 8


@pytest.mark.postgresql
def test_concurrent_actions_do_not_block_each_other(api, run_id):
    with ThreadPoolExecutor(24) as pool:
        answers = list(pool.map(lambda _: api.post(f"runs/{run_id}/cancel"), range(24)))
    assert sorted(answer.status_code for answer in answers) == [202] + 23 * [409]


@pytest.fixture
def summaries(record):
    """Twelve generations, of which every fifth tells a score."""
    for generation in range(1, 13):
        summary = {"inserted": generation, "ended.fitness": 3, "fine": True}
        if generation % 5 == 0:
            summary["corrected"] = 0.5 * generation
        record(generation, summary=summary)


def test_curves_and_events_contain_the_numbers_of_summaries(api, run_id, summaries, published):
    curves = api.get(f"runs/{run_id}/generations").json()
    assert curves["generation"] == list(range(1, 13))
    assert list(curves["summary"]) == ["inserted", "corrected"]
    assert curves["summary"]["inserted"] == curves["generation"]
    known = dict(zip(curves["generation"], curves["summary"]["corrected"], strict=True))
    assert {g: value for g, value in known.items() if value is not None} == {5: 2.5, 10: 5.0}
    thin = api.get(f"runs/{run_id}/generations", params={"points": 3}).json()
    assert thin["generation"] == [1, 7, 12]
    assert thin["summary"] == {"inserted": [1, 7, 12], "corrected": [None, 2.5, 5.0]}
    events = [data for kind, data in published() if kind == "generation"]
    assert [event["summary"].get("corrected") for event in events[3:6]] == [None, 2.5, None]


def test_a_run_that_ended_early_is_done(api, run_id, attempt, record):
    record(1, summary={"ended.fitness": 1})
    attempt.save(1, b"the archive")
    attempt.finish()
    run = api.get(f"runs/{run_id}").json()
    assert (run["status"], run["progress"], run["generation"]) == ("finished", 1.0, 1)


def test_species_are_listed_by_generation(api, run_id, record):
    record(1, summary={"species.0": 10, "species.3": 6})
    record(2, summary={"device_seconds": 1.0})
    record(3, summary={"species.3": 16})
    for query in ({}, {"points": 2}):
        assert api.get(f"runs/{run_id}/species", params=query).json() == {
            "generation": [1, 3],
            "number": [[0, 3], [3]],
            "members": [[10, 6], [16]],
        }


def test_thinned_curves_sum_reasons_of_divergence(api, run_id, record):
    for generation in range(1, 11):
        summary = {"infeasible.non-finite": 2, "inserted": generation}
        summary |= {"infeasible.supersonic": 1} if generation == 4 else {}
        record(generation, summary=summary)
    columns = api.get(f"runs/{run_id}/generations", params={"points": 3}).json()["summary"]
    assert sum(filter(None, columns["infeasible.non-finite"])) == 20
    assert sum(filter(None, columns["infeasible.supersonic"])) == 1
    assert columns["inserted"][-1] == 10


def test_targets_are_scaled_as_the_filaments_see_them(api, services, run_id):
    (demo,) = (one.spec for one in EXPERIMENTS["folding"].presets if one.name == "demo")
    fold_id = submit(services, demo)[0].id
    first, second = api.get(f"runs/{fold_id}/targets").json()
    assert (first["name"], second["name"]) == ("3", "7")
    assert (first["width"], first["height"], first["size"]) == (32, 32, 32)
    ink = targets.decoded(first["pixels"], 32, 32)
    assert abs(ink - targets.fitted(targets.digit(3), 32)).max() < 1 / 255
    assert base64.b64decode(first["pixels"]) != base64.b64decode(second["pixels"])
    assert "has no pictures" in detail(api.get(f"runs/{run_id}/targets"), 404)
