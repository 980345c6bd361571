"""The order in which runs are taken: fair to owners, true to priorities and interruptions."""

from datetime import UTC, datetime, timedelta
from uuid import UUID, uuid4

import pytest
from reports import DEMO

from server.attempts.claim import claim
from server.attempts.leases import end_job, fail_job
from server.auth import tokens
from server.auth.device_use import count_device_time
from server.runs.submission import IdempotentRequest, submit
from server.schedule.order import in_order, ordered
from server.tables import HIGH, LOW, NORMAL, URGENT, Run

pytestmark = pytest.mark.postgresql
ANNE, BERT = uuid4(), uuid4()
START = datetime(2026, 1, 1, tzinfo=UTC)


def queued(owner, at, priority=NORMAL, *, sweep=False, interrupted=False, worker=None):
    moment = START + timedelta(minutes=at)
    return Run(
        id=uuid4(),
        owner=owner,
        sweep=uuid4() if sweep else None,
        priority=priority,
        interrupted=interrupted,
        worker=worker,
        created_at=moment,
        queued_at=moment,
    )


def test_owners_take_turns_however_many_runs_one_of_them_has():
    many = [queued(ANNE, at) for at in range(5)]
    late = [queued(BERT, 60), queued(BERT, 61)]
    turns = [many[0], late[0], many[1], late[1], *many[2:]]
    assert ordered([*late, *many], {}, {}) == turns
    assert ordered([*late, *many], {ANNE: 1}, {}) == [late[0], many[0], late[1], *many[1:]]


def test_of_equal_turns_the_owner_with_less_device_time_goes_first():
    anne, bert = queued(ANNE, 0), queued(BERT, 60)
    assert ordered([anne, bert], {}, {ANNE: 10.0, BERT: 5.0}) == [bert, anne]
    assert ordered([anne, bert], {}, {ANNE: 10.0, BERT: 50.0}) == [anne, bert]


def test_priorities_order_the_runs_of_one_owner_and_urgent_ones_go_before_all():
    low, normal, high = (queued(ANNE, at, one) for at, one in enumerate((LOW, NORMAL, HIGH)))
    other = queued(BERT, 60, LOW)
    assert ordered([low, normal, high, other], {}, {}) == [high, other, normal, low]
    urgent = queued(ANNE, 90, URGENT)
    assert ordered([low, high, other, urgent], {ANNE: 7}, {})[0] is urgent


def test_taken_and_interrupted_runs_come_first_and_count_as_turns():
    urgent = queued(ANNE, 0, URGENT)
    lost = queued(BERT, 2, LOW, sweep=True, interrupted=True)
    taken = queued(BERT, 3, worker="worker")
    waiting, other = queued(BERT, 1), queued(ANNE, 4)
    found = ordered([urgent, waiting, lost, taken, other], {}, {})
    assert found == [taken, lost, urgent, other, waiting]


def test_single_runs_go_before_sweeps_of_the_same_owner():
    sweep, single = queued(ANNE, 0, sweep=True), queued(ANNE, 60)
    assert ordered([sweep, single], {}, {}) == [single, sweep]


@pytest.fixture
def token(services):
    """Creates tokens with quotas, and returns their ids."""

    def create(name, **quota):
        return tokens.create(services, name, "write", **quota).token.id

    return create


def test_the_device_time_of_an_owner_is_counted_by_day(services, token, claim_run, report):
    owner = token("anne")
    claim_run().record(report(1), 40.0)
    with services.sessions.write.begin() as session:
        count_device_time(session, owner, 30.0)
        count_device_time(session, owner, 12.0)
    mine = submit(services, DEMO, IdempotentRequest({}, None, owner))[0].id
    nobodys = submit(services, DEMO, IdempotentRequest({}, None, None))[0].id
    with services.sessions.read() as session:
        found = [run.id for run in in_order(session)]
    assert found == [mine, nobodys], "whoever has no token has a run already"


@pytest.mark.parametrize("died", [False, True])
def test_an_interrupted_run_goes_before_all_that_wait(
    api, services, spec, taken, waiting, flush, died
):
    """Its worker stopped, as in a rolling restart, or died."""
    first, *others = [api.post("runs", json=spec).json()["id"] for _ in range(3)]
    assert taken("one") == first
    if died:
        fail_job(services, UUID(first), "one", "its process died")
    else:
        services_claim(services, first, "one")
        end_job(services, UUID(first), "one")
    flush()
    assert waiting() == [first, *others]
    assert api.post("runs/estimate", json=spec).json()["queue"]["runs_ahead"] == 3
    assert taken("two") == first


def services_claim(services, run, worker):
    assert claim(services, UUID(run), worker)


def test_a_run_that_a_person_resumes_goes_behind_those_that_wait(api, spec, taken, waiting):
    first, *others = [api.post("runs", json=spec).json()["id"] for _ in range(3)]
    assert taken() == first
    for command in ("pause", "resume"):
        assert api.post(f"runs/{first}/{command}").status_code < 300
    assert waiting() == [*others, first]


def test_a_list_of_one_owners_runs_is_the_order_of_submission(api, spec, waiting):
    ids = [api.post("runs", json={**spec, "seed": seed}).json()["id"] for seed in range(5)]
    assert waiting() == ids
