"""Workers get the runs that they can carry out, each run one worker, within quotas."""

from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from uuid import UUID

import httpx
import pytest
import reports

from server.attempts.claim import claim
from server.attempts.leases import end_job, fail_job, heartbeat
from server.attempts.preemption import make_room
from server.auth import tokens
from server.auth.device_use import count_device_time
from server.core.database import now
from server.maintenance.reconcile import reconcile
from server.runs.submission import IdempotentRequest, submit
from server.schedule.take import take
from server.tables import Run

pytestmark = pytest.mark.postgresql
GPU, CPU = "gpu, H100, jax 1", "cpu, jax 1"


@pytest.fixture
def post(api, spec):
    """Submits a run and returns its id."""

    def post(**scheduling):
        answer = api.post("runs", json=spec, params=scheduling)
        assert answer.status_code == 202, answer.text
        return answer.json()["id"]

    return post


def test_a_run_has_one_worker_even_if_many_ask_at_once(services, alive, post):
    ids = {post() for _ in range(5)}
    names = [f"worker {number}" for number in range(8)]
    for name in names:
        alive(name)
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda name: take(services, name), names))
    assert {str(one) for one in found if one} == ids
    assert found.count(None) == 3


def test_a_taken_run_is_claimed_by_its_worker_alone(services, post, taken, reason):
    run = post()
    assert taken("one") == run
    assert reason(run) == "Worker one is about to start it."
    assert taken("two") is None
    assert heartbeat(services.sessions, UUID(run), "one") == "waiting"
    assert heartbeat(services.sessions, UUID(run), "two") == "lost"
    assert claim(services, UUID(run), "two") is None
    assert claim(services, UUID(run), "one")
    assert heartbeat(services.sessions, UUID(run), "one") == "held"


def test_a_run_taken_by_a_worker_that_dies_before_its_claim_returns(
    services, post, taken, silence
):
    run = post()
    assert taken("one") == run
    reconcile(services)
    assert taken("two") is None
    silence()
    reconcile(services)
    assert taken("two") == run


def test_a_worker_with_a_problem_or_unknown_takes_nothing(services, post, taken):
    post()
    assert taken("broken", problem="Its self-test fails: no GPU") is None
    assert take(services, "unknown") is None


def test_memory_and_labels_decide_which_worker_takes_a_run(
    services, api, spec, post, taken, reason
):
    needed = api.post("runs/estimate", json=spec).json()["memory_bytes"]
    run = post(labels=["fast", "room=2"])
    assert taken("small", memory=needed - 1, labels=["fast", "room=2"]) is None
    assert taken("slow", memory=needed, labels=["room=2"]) is None
    assert reason(run).startswith("Needs ")
    assert taken("right", memory=needed, labels=["fast", "room=2", "more"]) == run


def test_a_run_names_the_labels_that_it_waits_for(post, alive, reason):
    run = post(labels="fast")
    alive(labels=["slow"])
    words = "Waits for a worker with the label fast; labels of live workers: slow."
    assert reason(run) == words


@pytest.fixture
def begun(services, post, taken):
    """A run with a checkpoint from a GPU, back in the queue."""
    run = post()
    assert taken("first", device_kinds=[GPU]) == run
    attempt = claim(services, UUID(run), "first")
    attempt.record_device(GPU)
    attempt.record(reports.report(1), 1.0)
    attempt.save(1, b"state")
    attempt.requeue()
    return run


def test_a_run_returns_to_its_kind_of_device_while_others_idle(
    services, api, begun, taken, reason, update_rows
):
    update_rows(Run, worker=None)
    assert taken("processor", device_kinds=[CPU]) is None
    assert "1 run" not in reason(begun)
    assert taken("first", device_kinds=[GPU]) == begun


def test_another_kind_of_device_continues_after_the_owners_patience(
    services, api, begun, taken, reason, alive, update_rows
):
    alive("first", device_kinds=[CPU])
    words = f"Waits for a worker whose device repeats its bits, of the kind {GPU}: none "
    assert reason(begun).startswith(words)
    assert reason(begun).endswith("continues it once its owner allows it.")
    answer = api.patch(f"runs/{begun}", json={"device_patience": 3600})
    assert answer.json()["device_patience"] == 3600
    assert taken("processor", device_kinds=[CPU]) is None
    with services.sessions.read() as session:
        end = now(session) + timedelta(hours=1)
    assert f"continues it after {end:%Y-%m-%d %H}" in reason(begun)
    update_rows(Run, device_patience=0.0)
    assert taken("processor", device_kinds=[CPU]) == begun
    assert claim(services, UUID(begun), "processor").other_device


def test_a_run_on_its_own_kind_of_device_needs_no_leave(services, begun, taken):
    assert taken("first", device_kinds=[GPU, CPU]) == begun
    assert not claim(services, UUID(begun), "first").other_device


def test_a_run_that_failed_on_a_worker_goes_to_another_that_is_free(
    services, post, taken, alive
):
    run = post()
    alive("two")
    assert taken("one") == run
    fail_job(services, UUID(run), "one", "its process died")
    assert taken("one") is None
    assert taken("two") == run
    fail_job(services, UUID(run), "two", "its process died")
    alive("one", problem="Its self-test fails")
    assert taken("two") == run, "there is no other"


def test_a_stopped_worker_may_have_its_run_again(services, post, taken, alive):
    run = post()
    alive("two")
    assert taken("one") == run
    end_job(services, UUID(run), "one")
    assert taken("one") == run


def submitted(services, owner):
    return str(submit(services, reports.DEMO, IdempotentRequest({}, None, owner))[0].id)


def test_quotas_hold_back_further_runs_and_say_so(services, api, taken, reason):
    owner = tokens.create(services, "anne", "write", max_running=1, max_queued=3).token.id
    first, second = submitted(services, owner), submitted(services, owner)
    assert taken("one") == first
    assert taken("two") is None
    assert reason(second) == "Waits: `anne` may compute 1 run at a time."
    other = submitted(services, None)
    assert taken("two") == other
    submitted(services, owner)
    with pytest.raises(Exception, match="may have 3 queued runs; it has 3"):
        submitted(services, owner)
    found = {one["id"]: one for one in api.get("tokens").json()}[str(owner)]
    assert (found["max_running"], found["max_queued"], found["device_hours"]) == (1, 3, None)
    changed = api.patch(f"tokens/{owner}", json={"max_running": None, "device_hours": 2})
    assert (changed.json()["max_running"], changed.json()["max_queued"]) == (None, 3)
    with services.sessions.write.begin() as session:
        count_device_time(session, owner, 3 * 3600.0)
    assert taken("three") is None
    words = "Waits: `anne` has used 3.0 of its 2 device hours in 30 days."
    assert reason(second) == words
    assert {one["name"]: one["used_hours"] for one in api.get("tokens").json()}["anne"] == 3


def test_a_run_yields_to_an_urgent_one_if_its_owner_allows(services, api, post, taken, waiting):
    stubborn, yielding = post(), post(may_yield=True)
    for name, run in (("one", stubborn), ("two", yielding)):
        assert taken(name) == run
        assert claim(services, UUID(run), name)
    assert make_room(services) == []
    urgent, another = post(priority="urgent"), post(priority="urgent")
    assert make_room(services) == [UUID(yielding)]
    assert make_room(services) == [], "one run has been asked"
    run = api.get(f"runs/{yielding}").json()
    assert (run["status"], run["requested_state"]) == ("running", "queued")
    log = [one["text"] for one in api.get(f"runs/{yielding}/log").json()["entries"]]
    assert f"Yields its worker to the urgent run {urgent}." in log
    with services.sessions.read() as session:
        worker = session.get_one(Run, UUID(yielding)).worker
    end_job(services, UUID(yielding), worker)
    assert waiting() == [urgent, another, yielding]
    assert taken("two") == urgent


def test_an_urgent_run_with_a_free_worker_disturbs_nobody(services, post, taken, alive):
    run = post(may_yield=True)
    assert taken("one") == run
    claim(services, UUID(run), "one")
    post(priority="urgent")
    alive("two")
    assert make_room(services) == []


def test_only_an_admin_may_call_a_run_urgent(services, serve, spec, run_id):
    secret = tokens.create(services, "anne", "write").secret
    tokens.create(services, "root", "admin")
    with serve(auth="required") as address:
        headers = {"Authorization": f"Bearer {secret}"}
        for priority, status in (("urgent", 403), ("high", 202), ("loud", 422)):
            answer = httpx.post(
                f"{address}/api/v1/runs",
                json=spec,
                params={"priority": priority},
                headers=headers,
                timeout=30,
            )
            assert answer.status_code == status, answer.text
        listed = httpx.get(f"{address}/api/v1/runs", headers=headers, timeout=30)
        run = listed.json()["items"][0]
        assert run["priority"] == "high"
        path = f"{address}/api/v1/runs/{run['id']}"
        answer = httpx.patch(path, json={"priority": "urgent"}, headers=headers, timeout=30)
        assert answer.status_code == 403
        answer = httpx.patch(path, json={"priority": "low"}, headers=headers, timeout=30)
        assert (answer.status_code, answer.json()["priority"]) == (200, "low")
