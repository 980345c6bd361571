"""The order in which runs are taken: fair to owners, true to priorities and interruptions."""

import random
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from uuid import UUID, uuid4

import pytest
from reports import DEMO
from sqlalchemy import update

from microcosmos_server.attempts.claim import claim
from microcosmos_server.attempts.leases import end_job, fail_job
from microcosmos_server.auth import tokens
from microcosmos_server.auth.device_use import count_device_time
from microcosmos_server.runs.submission import IdempotentRequest, submit
from microcosmos_server.tables import HIGH, LOW, NORMAL, RUNNING, URGENT, Run

pytestmark = pytest.mark.postgresql
ANNE, BERT, CARL = uuid4(), uuid4(), None
START = datetime(2026, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class Queued:
    """What decides about the place of a run, and its name in these tests."""

    owner: UUID | None
    minute: int
    priority: str = NORMAL
    sweep: bool = False
    interrupted: bool = False
    worker: str | None = None


@pytest.fixture
def ordered(services, waiting):
    """Submits runs, and returns them in the order in which the database puts them.

    Some owners have running runs, or have used device time.
    """

    def ordered(queued, running=(), used=None):
        names = {}
        for owner in running:
            create(services, Queued(owner, 0, worker="worker"), status=RUNNING)
        with services.sessions.write.begin() as session:
            for owner, seconds in (used or {}).items():
                count_device_time(session, owner, seconds)
        for run in queued:
            names[create(services, run)] = run
        return [names[run_id] for run_id in waiting()]

    return ordered


def create(services, run, **columns):
    """Submit a run and set what decides about its place; return its id."""
    made = submit(services, DEMO)[0].id
    moment = START + timedelta(minutes=run.minute)
    columns |= {
        "owner": run.owner,
        "sweep": uuid4() if run.sweep else None,
        "priority": run.priority,
        "interrupted": run.interrupted,
        "worker": run.worker,
        "created_at": moment,
        "queued_at": moment,
    }
    with services.sessions.write.begin() as session:
        session.execute(update(Run).where(Run.id == made).values(columns))
    return str(made)


def test_owners_take_turns_however_many_runs_one_of_them_has(ordered):
    many = [Queued(ANNE, at) for at in range(5)]
    late = [Queued(BERT, 60), Queued(BERT, 61)]
    turns = [many[0], late[0], many[1], late[1], *many[2:]]
    assert ordered([*late, *many]) == turns


def test_taken_and_interrupted_runs_come_first_and_count_as_turns(ordered):
    urgent = Queued(ANNE, 0, URGENT)
    lost = Queued(BERT, 2, LOW, sweep=True, interrupted=True)
    taken = Queued(BERT, 3, worker="worker")
    waiting, other = Queued(BERT, 1), Queued(ANNE, 4)
    found = ordered([urgent, waiting, lost, taken, other])
    assert found == [taken, lost, urgent, other, waiting]


def by_the_rules(queued, running, used):
    """Order runs without a database: a turn is the number of the owner's runs before."""

    def own(run):
        sweep = run.sweep and not run.interrupted
        rank = [URGENT, HIGH, NORMAL, LOW].index(run.priority)
        return run.worker is None, not run.interrupted, rank, sweep, run.minute

    def key(run):
        before = [one for one in queued if one.owner == run.owner and own(one) < own(run)]
        turn = running.count(run.owner) + len(before)
        first = run.worker is None, not run.interrupted, run.priority != URGENT
        return *first, turn, used.get(run.owner, 0.0), own(run)

    return sorted(queued, key=key)


@pytest.mark.parametrize("seed", range(2))
def test_mixed_queues_are_in_the_order_that_the_rules_tell(ordered, seed):
    draw = random.Random(seed)
    queued = [
        Queued(
            owner=draw.choice([ANNE, BERT, CARL]),
            minute=minute,
            priority=draw.choice([URGENT, HIGH, NORMAL, NORMAL, LOW]),
            sweep=draw.random() < 0.3,
            interrupted=draw.random() < 0.2,
            worker=draw.choice([None] * 5 + ["worker"]),
        )
        for minute in draw.sample(range(1000), 40)
    ]
    running, used = draw.choices([ANNE, BERT, CARL], k=4), {ANNE: 3.0, CARL: 1.0}
    assert ordered(queued, running, used) == by_the_rules(queued, running, used)


@pytest.fixture
def token(services):
    """Creates tokens with quotas, and returns their ids."""

    def create(name, **quota):
        return tokens.create(services, name, "write", **quota).token.id

    return create


def test_the_device_time_of_an_owner_is_counted_by_day(
    services, token, claim_run, report, waiting
):
    owner = token("anne")
    claim_run().record(report(1), 40.0)
    with services.sessions.write.begin() as session:
        count_device_time(session, owner, 30.0)
        count_device_time(session, owner, 12.0)
    mine = submit(services, DEMO, IdempotentRequest({}, None, owner))[0].id
    nobodys = submit(services, DEMO, IdempotentRequest({}, None, None))[0].id
    assert waiting() == [str(mine), str(nobodys)], "whoever has no token has a run already"


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
        assert claim(services, UUID(first), "one")
        end_job(services, UUID(first), "one")
    flush()
    assert waiting() == [first, *others]
    assert api.post("runs/estimate", json=spec).json()["queue"]["runs_ahead"] == 3
    assert taken("two") == first


def test_a_run_that_a_person_resumes_goes_behind_those_that_wait(api, spec, taken, waiting):
    first, *others = [api.post("runs", json=spec).json()["id"] for _ in range(3)]
    assert taken() == first
    for command in ("pause", "resume"):
        assert api.post(f"runs/{first}/{command}").status_code < 300
    assert waiting() == [*others, first]
