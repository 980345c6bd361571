"""The bin: what lies there is out of sight, comes back whole, or goes with all that is its."""

import pytest
from deletion import delete_for_good, files, finish, let_time_pass, rows

from server.attempts.claim import claim
from server.maintenance.reconcile import reconcile
from server.tables import (
    Run,
)

pytestmark = pytest.mark.postgresql


def test_a_deleted_run_is_out_of_sight_and_comes_back_as_it_was(api, services, run_id, report):
    finish(services, run_id, report(1, {0: 1.0}))
    api.patch(f"runs/{run_id}", json={"tags": ["mine"]})
    before = api.get(f"runs/{run_id}").json()
    deleted = api.delete(f"runs/{run_id}")
    assert deleted.status_code == 200
    assert deleted.json()["deleted_at"]
    assert deleted.json()["purge_at"] > deleted.json()["deleted_at"]
    assert api.get("runs").json()["items"] == api.get("tags").json() == []
    assert [r["id"] for r in api.get("runs?deleted=true").json()["items"]] == [str(run_id)]
    assert api.get(f"runs/{run_id}").json() == deleted.json()
    for path in ("archive", "archive.h5", "generations", "log"):
        answer = api.get(f"runs/{run_id}/{path}")
        assert answer.status_code == 404, path
    answer = api.get(f"runs/{run_id}/archive")
    assert "is in the bin until" in answer.json()["detail"]
    for action in ("resume", "cancel", "extend"):
        sent = {"json": {"generations": 1}} if action == "extend" else {}
        assert api.post(f"runs/{run_id}/{action}", **sent).status_code == 404
    assert api.post(f"runs/{run_id}/restore").json() == before
    assert api.get("runs?deleted=true").json()["items"] == []
    assert api.get(f"runs/{run_id}/archive").json()["cell"] == [0]


def test_nobody_deletes_what_is_at_work_or_waits(api, services, run_id):
    attempt = None
    for standing in ("queued", "running"):
        answer = api.delete(f"runs/{run_id}")
        assert answer.status_code == 409
        assert f"cancel it first; it is {standing}" in answer.json()["detail"]
        attempt = attempt or claim(services, run_id, "worker")
    api.post(f"runs/{run_id}/pause")
    attempt.pause()
    assert api.delete(f"runs/{run_id}").json()["status"] == "paused"
    assert api.delete(f"runs/{run_id}").status_code == 404


def test_only_what_lies_in_the_bin_is_restored_and_only_in_time(api, services, run_id):
    api.post(f"runs/{run_id}/cancel")
    answer = api.post(f"runs/{run_id}/restore")
    assert answer.status_code == 409
    assert "it is cancelled" in answer.json()["detail"]
    api.delete(f"runs/{run_id}")
    let_time_pass(services, run_id)
    answer = api.post(f"runs/{run_id}/restore")
    assert answer.status_code == 409
    assert api.get(f"runs/{run_id}").json()["deleted_at"]


def test_what_is_in_the_bin_stays_for_a_day(api, services, run_id, report):
    finish(services, run_id, report(1, {0: 1.0}))
    api.delete(f"runs/{run_id}")
    before = rows(services), files(services)
    reconcile(services)
    assert (rows(services), files(services)) == before
    with services.sessions.read() as session:
        run = session.get_one(Run, run_id)
    assert (run.purge_at - run.deleted_at).total_seconds() == 86_400


def test_everybody_is_told_that_a_run_is_gone(api, services, run_id):
    api.post(f"runs/{run_id}/cancel")
    delete_for_good(api, services, run_id)
    told = [f[b"event"] for _, f in services.redis.xrange(services.events.stream)]
    assert told[-2:] == [b"run", b"purge"]
