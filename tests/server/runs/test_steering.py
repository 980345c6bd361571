"""Pausing, resuming and cancelling runs, and what their progress says."""

from concurrent.futures import ThreadPoolExecutor
from uuid import uuid4

import pytest

from server.attempts.claim import claim


def test_a_waiting_run_is_paused_resumed_and_cancelled_at_once(api, services, run_id, flush):
    assert api.post(f"runs/{run_id}/pause").json()["status"] == "paused"
    assert claim(services, run_id, "worker") is None
    flush()
    assert api.post(f"runs/{run_id}/resume").json()["status"] == "queued"
    assert services.jobs.runs.get_job_ids() == [str(run_id)]
    cancelled = api.post(f"runs/{run_id}/cancel").json()
    assert cancelled["status"] == "cancelled"
    assert cancelled["finished_at"]
    assert claim(services, run_id, "worker") is None


def test_a_running_run_is_asked_and_its_worker_obeys(api, services, run_id, report):
    attempt = claim(services, run_id, "worker")
    paused = api.post(f"runs/{run_id}/pause").json()
    assert (paused["status"], paused["requested_state"]) == ("running", "paused")
    attempt.record(report(1), 1.0)
    assert attempt.requested_state == "paused"
    attempt.pause()
    run = api.get(f"runs/{run_id}").json()
    assert (run["status"], run["requested_state"]) == ("paused", None)
    api.post(f"runs/{run_id}/resume")
    attempt = claim(services, run_id, "worker")
    api.post(f"runs/{run_id}/cancel")
    attempt.check()
    assert attempt.requested_state == "cancelled"
    attempt.cancel()
    assert api.get(f"runs/{run_id}").json()["status"] == "cancelled"


def test_a_cancellation_overrules_a_pause_and_not_the_reverse(api, services, run_id):
    claim(services, run_id, "worker")
    api.post(f"runs/{run_id}/pause")
    assert api.post(f"runs/{run_id}/cancel").json()["requested_state"] == "cancelled"
    assert api.post(f"runs/{run_id}/pause").status_code == 409


def test_what_the_state_forbids_is_a_conflict_that_says_why(api, services, run_id):
    answer = api.post(f"runs/{run_id}/resume")
    assert answer.status_code == 409
    assert answer.json()["detail"] == "to resume a run it must be paused; it is queued"
    claim(services, run_id, "worker").finish()
    for action in ("pause", "resume", "cancel"):
        answer = api.post(f"runs/{run_id}/{action}")
        assert answer.status_code == 409
        assert "it is finished" in answer.json()["detail"]


def test_progress_is_what_was_recorded(api, services, run_id, report):
    attempt = claim(services, run_id, "worker")
    attempt.use("a device")
    for generation, seconds in ((1, 20.0), (2, 6.0), (3, 2.0)):
        attempt.record(report(generation), seconds)
    run = api.get(f"runs/{run_id}").json()
    assert run["generation"] == 3
    assert run["progress"] == 3 / run["generations"]
    assert run["evaluations"] == 48
    assert run["evaluations_per_second"] == 8.0
    assert run["eta_seconds"] == (run["generations"] - 3) * 16 / 8
    assert run["sparkline"] == [10, 20, 30]
    assert run["device"] == "a device"


def test_of_a_run_that_is_done_the_rate_is_that_of_all_but_the_first_generation(
    api, services, run_id, report
):
    attempt = claim(services, run_id, "worker")
    for generation, seconds in ((1, 20.0), (2, 6.0), (3, 2.0)):
        attempt.record(report(generation), seconds)
    attempt.finish()
    assert api.get(f"runs/{run_id}").json()["evaluations_per_second"] == 32 / 8


def test_a_single_generation_has_a_rate_with_its_compilation(api, services, run_id, report):
    assert api.get(f"runs/{run_id}").json()["evaluations_per_second"] is None
    claim(services, run_id, "worker").record(report(1), 20.0)
    assert api.get(f"runs/{run_id}").json()["evaluations_per_second"] == 16 / 20


def test_curves_are_columns_of_all_or_some_generations(api, services, run_id, report):
    empty = api.get(f"runs/{run_id}/generations").json()
    assert empty["generation"] == []
    attempt = claim(services, run_id, "worker")
    for generation in range(1, 41):
        attempt.record(report(generation), 0.5)
    curves = api.get(f"runs/{run_id}/generations").json()
    assert curves["generation"] == list(range(1, 41))
    assert curves["seconds"][-1] == 20.0
    assert curves["mean"][3] == 2.0
    some = api.get(f"runs/{run_id}/generations", params={"points": 5}).json()
    assert some["generation"] == [1, 11, 21, 30, 40]


@pytest.mark.postgresql
def test_many_that_steer_at_once_do_not_wait_for_each_other(api, run_id):
    with ThreadPoolExecutor(24) as pool:
        answers = list(pool.map(lambda _: api.post(f"runs/{run_id}/cancel"), range(24)))
    assert sorted(answer.status_code for answer in answers) == [202] + 23 * [409]


def test_an_unknown_run_cannot_be_steered(api):
    for action in ("pause", "resume", "cancel"):
        assert api.post(f"runs/{uuid4()}/{action}").status_code == 404
        assert api.post(f"runs/nonsense/{action}").status_code == 422
