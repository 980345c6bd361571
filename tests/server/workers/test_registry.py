"""Workers, the queue, and why runs wait, over HTTP."""

from uuid import UUID

import pytest

from microcosmos_server.attempts.claim import claim
from microcosmos_server.runs.overview import read_runs
from microcosmos_server.tables import Run


@pytest.fixture
def submit(api, spec):
    """Submits runs that differ by their seed, and returns their ids."""

    def submit(count):
        runs = [{**spec, "seed": seed} for seed in range(count)]
        return [api.post("runs", json=run).json()["id"] for run in runs]

    return submit


def test_a_worker_reports_its_device_load_and_run(api, spec, run_id, alive, record):
    record(5)
    api.patch(f"runs/{run_id}", json={"name": "Wide"})
    alive("worker", "busy", run_id, kind="gpu", memory_used_bytes=1 << 30, load=0.75)
    (found,) = api.get("workers").json()
    assert (found["status"], found["run"]) == ("busy", str(run_id))
    assert (found["kind"], found["load"]) == ("gpu", 0.75)
    assert (found["memory_used_bytes"], found["memory_bytes"]) == (1 << 30, 1 << 40)
    carried = found["current_run"]
    assert (carried["id"], carried["name"], carried["attempt"]) == (str(run_id), "Wide", 1)
    assert carried["generation"] == 5
    assert carried["generations"] == spec["search"]["generations"]
    assert carried["progress"] == 5 / carried["generations"]


def test_the_queue_lists_waiting_runs_in_order(api, services, spec, submit, reason):
    ids = submit(4)
    api.post(f"runs/{ids[0]}/pause")
    claim(services, UUID(ids[1]), "worker")
    api.post(f"runs/{ids[0]}/resume")
    queue = api.get("queue").json()
    assert (queue["total"], [run["id"] for run in queue["items"]]) == (3, [*ids[2:], ids[0]])
    needed = api.post("runs/estimate", json=spec).json()["memory_bytes"]
    assert {run["memory_bytes"] for run in queue["items"]} == {needed}
    first = api.get("queue", params={"limit": 1}).json()
    assert (first["total"], [run["id"] for run in first["items"]]) == (3, [ids[2]])
    assert first["items"][0]["waiting_reason"] == reason(ids[2])


def test_only_runs_that_are_queued_wait(api, run_id, reason, claim_run, report):
    assert "`make run` or `python -m microcosmos_worker.supervisor`" in reason(run_id)
    api.post(f"runs/{run_id}/pause")
    assert reason(run_id) is None
    api.post(f"runs/{run_id}/resume")
    attempt = claim_run()
    assert reason(run_id) is None
    attempt.record(report(1), 1.0)
    attempt.finish()
    assert reason(run_id) is None


def test_a_queued_run_names_busy_workers_and_its_position(services, submit, alive, reason):
    ids = submit(4)
    claim(services, UUID(ids[0]), "worker")
    alive("worker", "busy", UUID(ids[0]))
    busy = f"Waits for a worker: the only one is busy with run {ids[0][:8]}; "
    assert reason(ids[0]) is None
    assert reason(ids[1]) == busy + "this run is next."
    assert reason(ids[2]) == busy + "1 run is before it."
    assert reason(ids[3]) == busy + "2 runs are before it."
    claim(services, UUID(ids[1]), "another")
    alive("another", "busy", UUID(ids[1]))
    assert reason(ids[2]) == "Waits for a worker: all 2 are busy; this run is next."
    alive("third")
    assert reason(ids[3]) == "A worker is free; 1 run is before it."


def test_a_list_asks_the_queue_once_however_many_runs_wait(services, submit, alive, statements):
    alive()
    ids = submit(3)

    def count(limit):
        with services.sessions.read() as session:
            runs = [session.get(Run, UUID(run_id)) for run_id in ids[:limit]]
            return statements(read_runs, services, session, runs)

    assert count(1) == count(3) > 0
