"""Retention: what is older than the settings say goes, and nothing else."""

import math
from datetime import timedelta

import pytest
from deletion import files, finish, row_counts
from sqlalchemy import select

from microcosmos.archive import creature
from microcosmos.spec import parse
from microcosmos_server.attempts.claim import claim
from microcosmos_server.auth.device_use import count_device_time, device_seconds
from microcosmos_server.core.database import now
from microcosmos_server.deletion import purge
from microcosmos_server.maintenance.reconcile import reconcile
from microcosmos_server.renderings.storage import existing, save
from microcosmos_server.runs.submission import submit
from microcosmos_server.settings import Settings
from microcosmos_server.tables import (
    AUDIT,
    CHECKPOINT,
    GIF,
    REPLAY,
    USE_DAYS,
    Artifact,
    Creature,
    DeviceUse,
    LogEntry,
    Run,
)

pytestmark = pytest.mark.postgresql
KEPT = [name for name in Settings.model_fields if name.startswith("keep_")]


@pytest.fixture
def expire(services, monkeypatch):
    """Expires with these settings; nothing else is due."""

    def expire(**keep):
        for name in KEPT:
            monkeypatch.setattr(services.settings, name, keep.get(name, math.inf))
        purge.expire(services)
        reconcile(services)

    return expire


@pytest.fixture
def age(services):
    """Moves a column of a table's rows into the past."""

    def age(column, days):
        with services.sessions.write.begin() as session:
            then = now(session) - timedelta(days=days)
            for row in session.scalars(select(column.class_)):
                setattr(row, column.key, then)

    return age


def checkpoints(services):
    with services.sessions.read() as session:
        mine = select(Artifact.number).where(Artifact.kind == CHECKPOINT)
        return sorted(session.scalars(mine))


def test_an_ended_run_keeps_its_last_checkpoint(services, run_id, report, expire, age, api):
    finish(services, run_id, *(report(g, {0: float(g)}) for g in (1, 2, 3)))
    before = api.get(f"runs/{run_id}/archive.h5").content
    age(Run.finished_at, 10)
    expire(keep_checkpoints=11.0)
    assert checkpoints(services) == [1, 2, 3]
    expire(keep_checkpoints=9.0)
    assert checkpoints(services) == [3]
    assert len(files(services)) == 1
    assert api.get(f"runs/{run_id}/archive.h5").content == before


def test_a_run_that_goes_on_keeps_all(services, attempt, record, expire):
    for generation in (1, 2):
        record(generation)
        attempt.save(generation, b"state %d" % generation)
    expire(keep_checkpoints=0.0, keep_logs=0.0)
    assert checkpoints(services) == [1, 2]
    assert row_counts(services)["log_entries"] > 0


def test_old_renderings_go_and_audits_stay(services, run_id, report, identity, expire, age):
    finish(services, run_id, report(1, {0: 1.0}), files=False)
    name = creature.name(identity(1000))
    save(services, name, REPLAY, b"old")
    save(services, name, AUDIT, b'{"verdict": {"trusted": true}}')
    age(Artifact.created_at, 100)
    save(services, name, GIF, b"new")
    expire(keep_renderings=99.0)
    found = [kind for kind in (REPLAY, AUDIT, GIF) if existing(services, name, kind)]
    assert found == [AUDIT, GIF]
    assert len(files(services)) == 2


def test_logs_of_ended_runs_go(services, run_id, report, expire, age, spec):
    finish(services, run_id, report(1, {0: 1.0}))
    age(Run.finished_at, 10)
    other = submit(services, parse(spec))[0].id
    expire(keep_logs=9.0)
    with services.sessions.read() as session:
        assert set(session.scalars(select(LogEntry.run_id))) == {other}


def test_old_device_time_goes_and_quotas_keep_theirs(services, expire):
    with services.sessions.write.begin() as session:
        count_device_time(session, None, 5.0)
        (today,) = session.scalars(select(DeviceUse))
        for days in (USE_DAYS - 1, 40):
            day = today.day - timedelta(days=days)
            session.add(DeviceUse(owner=today.owner, day=day, seconds=1.0))
    expire(keep_device_use=31.0)
    with services.sessions.read() as session:
        assert sorted(session.scalars(select(DeviceUse.seconds))) == [1.0, 5.0]
        assert device_seconds(session, USE_DAYS) == {None: 6.0}


def test_old_events_go(services, run_id, expire):
    services.redis.delete(services.events.stream)
    seconds, _ = services.redis.time()
    for days in (3, 1):
        at = 1000 * (seconds - 86_400 * days)
        services.redis.xadd(services.events.stream, {"event": str(days)}, id=f"{at}-0")
    expire(keep_events=2.0)
    left = services.redis.xrange(services.events.stream)
    assert [fields[b"event"] for _, fields in left] == [b"1"]


def test_replaced_elites_keep_their_pose_streams_while_they_are_due(
    services, run_id, report, expire, age
):
    first, second = report(1, {0: 1.0, 1: 1.0}, poses=True), report(2, {0: 2.0}, poses=True)
    names = [elite.creature for made in (first, second) for elite in made.elites]

    def kept():
        with services.sessions.read() as session:
            rows = {
                one.sha256: one.poses is not None for one in session.scalars(select(Creature))
            }
        return [rows[name] for name in names]

    finish(services, run_id, first, second)
    age(Run.finished_at, 10)
    expire(keep_poses=11.0)
    assert kept() == [True, True, True]
    expire(keep_poses=9.0)
    assert kept() == [False, True, True], "the first elite of cell 0 was replaced"


def test_pose_streams_of_elites_in_other_runs_stay(services, run_id, report, expire, age):
    old = [report(1, {0: 1.0}, poses=True), report(2, {0: 2.0}, poses=True)]
    finish(services, run_id, *old)
    age(Run.finished_at, 10)
    other = submit(services, parse({"experiment": "quality-diversity"}))[0].id
    claim(services, other, "worker").record(old[0], 1.0)
    expire(keep_poses=0.0)
    with services.sessions.read() as session:
        poses = [one.poses for one in session.scalars(select(Creature))]
    assert None not in poses
