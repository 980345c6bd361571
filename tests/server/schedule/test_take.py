"""Workers get the runs that they can carry out, each run one worker, within quotas."""

from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from uuid import UUID

import httpx
import pytest
import reports
from answers import detail

from microcosmos_server import schedule
from microcosmos_server.attempts.claim import claim
from microcosmos_server.attempts.leases import end_job, fail_job, heartbeat
from microcosmos_server.attempts.preemption import make_room
from microcosmos_server.auth import tokens
from microcosmos_server.auth.device_use import count_device_time
from microcosmos_server.core.database import ago, now
from microcosmos_server.core.errors import TooMany
from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.runs.submission import IdempotentRequest, submit
from microcosmos_server.schedule.take import take
from microcosmos_server.tables import Idempotency, Run

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


def test_a_run_that_was_paused_since_it_was_chosen_is_not_taken(
    services, api, alive, post, monkeypatch
):
    alive("one")
    run = UUID(post())
    api.post(f"runs/{run}/pause").raise_for_status()
    monkeypatch.setattr(schedule.take, "_next", lambda *_: run)  # As another process saw it.
    assert take(services, "one") is None
    with services.sessions.read() as session:
        assert session.get_one(Run, run).worker is None


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


def test_a_run_whose_attempt_on_another_kind_leaves_no_checkpoint_keeps_its_kind(
    services, api, begun, taken, update_rows
):
    """Its file has the bits of that kind, and other devices refuse it."""
    update_rows(Run, device_patience=0.0)
    for saves, kind in ((False, GPU), (True, CPU)):
        assert taken("processor", device_kinds=[CPU]) == begun
        attempt = claim(services, UUID(begun), "processor")
        attempt.record_device(CPU)
        attempt.record(reports.report(2), 1.0)
        if saves:
            attempt.save(2, b"state")
        attempt.requeue()
        assert api.get(f"runs/{begun}").json()["device"] == kind
        update_rows(Run, worker=None)
    update_rows(Run, device_patience=3600.0)
    assert taken("graphics", device_kinds=[GPU]) is None
    assert taken("processor", device_kinds=[CPU]) == begun


@pytest.mark.parametrize("computing", [False, True])
def test_patience_begins_anew_when_a_cancellation_is_taken_back(
    services, api, begun, taken, update_rows, computing
):
    """While it was computed or cancelled, the run did not wait for its kind of device."""
    update_rows(Run, device_patience=3600.0)
    if computing:
        assert taken("first", device_kinds=[GPU]) == begun
        attempt = claim(services, UUID(begun), "first")
    api.post(f"runs/{begun}/cancel")
    if computing:
        attempt.cancel()
    with services.sessions.read() as session:
        then = ago(session, 7200)
    update_rows(Run, queued_at=then, released_at=then)
    api.post(f"runs/{begun}/uncancel")
    assert taken("processor", device_kinds=[CPU]) is None
    assert taken("first", device_kinds=[GPU]) == begun


def test_patience_begins_anew_when_a_run_returns_at_the_last_moment(
    services, api, begun, taken, update_rows
):
    update_rows(Run, device_patience=3600.0)
    assert taken("first", device_kinds=[GPU]) == begun
    attempt = claim(services, UUID(begun), "first")
    with services.sessions.read() as session:
        then = ago(session, 7200)
    update_rows(Run, queued_at=then, released_at=then)
    attempt.cancel()  # It was asked to, and has looked before the undo.
    assert taken("processor", device_kinds=[CPU]) is None


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
    changed = api.patch(f"tokens/{owner}", json={"max_running": None, "device_hours": 2})
    assert (changed.json()["max_running"], changed.json()["max_queued"]) == (None, 3)
    with services.sessions.write.begin() as session:
        count_device_time(session, owner, 3 * 3600.0)
    assert taken("three") is None
    words = "Waits: `anne` has used 3.0 of its 2 device hours in 30 days."
    assert reason(second) == words


def test_many_requests_at_once_do_not_exceed_a_quota(services):
    owner = tokens.create(services, "anne", "write", max_queued=2).token.id

    def accepted(_):
        try:
            return submitted(services, owner)
        except TooMany:
            return None

    with ThreadPoolExecutor(8) as pool:
        assert sum(run is not None for run in pool.map(accepted, range(8))) == 2


def test_a_repeated_request_gives_the_run_that_filled_the_quota(services):
    owner = tokens.create(services, "anne", "write", max_queued=1).token.id

    def submitted_once(_):
        found = submit(services, reports.DEMO, IdempotentRequest({}, "a key", owner))
        return found.run_id if isinstance(found, Idempotency) else found[0].id

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(submitted_once, range(8)))) == 1


def test_whatever_queues_a_run_heeds_the_quota(services, api, update_rows):
    owner = tokens.create(services, "anne", "write", max_queued=1).token.id
    run = f"runs/{submitted(services, owner)}"
    refused = "`anne` may have 1 queued runs; it has 1, and this request adds 1."

    def instead(action):
        """Another run takes the place of one that leaves the queue."""
        assert api.post(f"{run}/{action}").status_code == 202
        return f"runs/{submitted(services, owner)}"

    for leave, back in (("pause", "resume"), ("cancel", "uncancel")):
        other = instead(leave)
        assert detail(api.post(f"{run}/{back}"), 429) == refused
        assert detail(api.post(f"{other}/{back}"), 409), "the state is refused first"
        api.post(f"{other}/cancel")
        assert api.post(f"{run}/{back}").json()["status"] == "queued"
    other = instead("pause")
    api.post(f"{run}/cancel")
    assert api.post(f"{run}/uncancel").json()["status"] == "paused", "it is not queued"
    update_rows(Run, Run.id == UUID(run.removeprefix("runs/")), status="finished")
    assert detail(api.post(f"{run}/extend", json={"generations": 1}), 429) == refused
    api.post(f"{other}/cancel")
    assert api.post(f"{run}/extend", json={"generations": 1}).status_code == 202


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


@pytest.fixture
def busy(services, taken):
    """Lets a new worker compute a run."""

    def busy(name, run, **more):
        assert taken(name, **more) == run
        assert claim(services, UUID(run), name)

    return busy


def test_an_urgent_run_with_a_free_worker_disturbs_nobody(services, post, busy, alive):
    busy("one", post(may_yield=True))
    post(priority="urgent")
    alive("two")
    assert make_room(services) == []


def test_each_urgent_run_needs_a_worker_of_its_own(services, post, busy, alive):
    busy("one", run := post(may_yield=True))
    alive("two")
    post(priority="urgent"), post(priority="urgent")
    assert make_room(services) == [UUID(run)], "the second one"
    assert make_room(services) == []


def test_urgent_runs_that_no_worker_fits_disturb_nobody(services, post, busy):
    for name in ("one", "two", "three"):
        busy(name, last := post(may_yield=True))
    for _ in range(2):
        post(priority="urgent", labels="absent")
    assert make_room(services) == []
    post(priority="urgent")
    assert make_room(services) == [UUID(last)]
    assert make_room(services) == []


def test_no_more_runs_yield_than_an_owner_may_compute(services, post, busy, update_rows):
    for name in ("one", "two", "three"):
        busy(name, last := post(may_yield=True))
    urgent = [UUID(post(priority="urgent")) for _ in range(3)]
    owner = tokens.create(services, "root", "admin", max_running=1).token.id
    update_rows(Run, Run.id.in_(urgent), owner=owner)
    assert make_room(services) == [UUID(last)]
    assert make_room(services) == []


def test_a_pause_of_a_run_elsewhere_frees_no_worker_that_fits(services, api, post, busy):
    busy("cpu", other := post())
    busy("gpu", run := post(may_yield=True, labels="gpu"), labels=["gpu"])
    api.post(f"runs/{other}/pause")
    post(priority="urgent", labels="gpu")
    assert make_room(services) == [UUID(run)]


def test_a_pause_on_a_worker_that_fits_is_waited_for(services, api, post, busy):
    busy("one", paused := post())
    busy("two", post(may_yield=True))
    api.post(f"runs/{paused}/pause")
    post(priority="urgent")
    assert make_room(services) == []


def test_a_worker_with_a_problem_is_not_yielded(services, post, busy, alive):
    busy("one", run := post(may_yield=True))
    alive("one", "busy", UUID(run), problem="Its self-test fails")
    post(priority="urgent")
    assert make_room(services) == []


def test_only_an_admin_may_call_a_run_urgent(services, served, spec):
    secret = tokens.create(services, "anne", "write").secret
    tokens.create(services, "root", "admin")
    sent = {"headers": {"Authorization": f"Bearer {secret}"}, "timeout": 30}
    with httpx.Client(base_url=f"{served(auth='required')}/api/v1", **sent) as http:
        for priority, status in (("urgent", 403), ("loud", 422), ("high", 202)):
            answer = http.post("/runs", json=spec, params={"priority": priority})
            assert answer.status_code == status, answer.text
        path = f"/runs/{answer.json()['id']}"
        assert http.patch(path, json={"priority": "urgent"}).status_code == 403
        assert http.patch(path, json={"priority": "low"}).json()["priority"] == "low"
