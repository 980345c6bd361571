"""Delete runs whose time in the bin has ended, garbage, and expired data.

Each step is a small transaction, and the database holds the remaining work: a pass may stop
anywhere, and the next one continues.
"""

import logging
import math
import time
from collections.abc import Callable, Collection
from contextlib import suppress
from datetime import datetime
from functools import partial
from typing import Any
from uuid import UUID

from redis import RedisError
from sqlalchemy import ColumnElement, delete, inspect, select, tuple_, union, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session, aliased

from ..auth.device_use import forget_device_time
from ..core.database import ago, clock, insert_missing
from ..creatures.storage import creatures_of, mark_garbage
from ..queue.jobs import ON_REQUEST
from ..runs.lifecycle import change
from ..services.services import Services
from ..storage import garbage as files
from ..storage.artifacts import run_folder
from ..storage.garbage import discard
from ..tables import (
    CHECKPOINT,
    TERMINAL,
    Artifact,
    Choice,
    Creature,
    Elite,
    GarbageCreature,
    Generation,
    Idempotency,
    InitialCreature,
    LogEntry,
    Parent,
    Result,
    Run,
    Share,
)

CREATURES_PER_TRANSACTION = 200


def in_use(session: Session, names: Collection[str]) -> set[str]:
    """Return those of the creatures that are in use. Each kind of use has a line here.

    A parent of a kept creature is in use, so that lineage stays complete.
    """
    uses = (
        select(Elite.creature).where(Elite.creature.in_(names)),
        select(Result.creature).where(Result.creature.in_(names)),
        select(InitialCreature.creature).where(InitialCreature.creature.in_(names)),
        select(Choice.creature).where(Choice.creature.in_(names)),
        select(Share.creature).where(Share.creature.in_(names)),
        select(Share.cover).where(Share.cover.in_(names)),
        select(Parent.parent).where(Parent.parent.in_(names)),
        select(Creature.sha256).where(Creature.sha256.in_(names), Creature.imported),
    )
    return {name for name in session.scalars(union(*uses)) if name is not None}


def collect(session: Session) -> bool:
    """Delete a few marked creatures unless in use; return False if none are left to check."""
    exists = select(Run.id).where(Run.id == GarbageCreature.run_id).exists()
    rows = (
        select(GarbageCreature)
        .where(~exists)
        .order_by(GarbageCreature.creature)
        .limit(CREATURES_PER_TRANSACTION)
    )
    checked = {row.creature: row.run_id for row in session.scalars(rows)}
    if not checked:
        return False
    # Transactions that would use one wait for this lock, and then find it deleted.
    locked = select(Creature).where(Creature.sha256.in_(checked)).order_by(Creature.sha256)
    found = {row.sha256: row.parents for row in session.scalars(locked.with_for_update())}
    gone = sorted(found.keys() - in_use(session, found))
    session.execute(
        delete(GarbageCreature).where(
            GarbageCreature.creature.in_(checked), GarbageCreature.run_id.in_(checked.values())
        )
    )
    # Rows of their renderings go too; files are deleted later.
    files = delete(Artifact).where(Artifact.creature.in_(gone)).returning(Artifact.path)
    discard(session, list(session.scalars(files)))
    session.execute(delete(Parent).where(Parent.child.in_(gone)))
    session.execute(delete(Creature).where(Creature.sha256.in_(gone)))
    # A parent may have been kept for its child alone.
    parents = {(checked[name], parent) for name in gone for parent in found[name]}
    rows = [{"run_id": run_id, "creature": parent} for run_id, parent in sorted(parents)]
    insert_missing(session, GarbageCreature, rows)
    return True


SECONDS = 2.0
"""Time for each kind of work in a pass: the reconciler has other work, which must not wait for
a large purge."""
ROWS_PER_TRANSACTION = 500

log = logging.getLogger(__name__)


def purge(services: Services) -> None:
    for step in (purge_rows, collect_creatures, remove_files):
        _repeat(partial(step, services))


def _repeat(step: Callable[[], object]) -> None:
    """Repeat a step until it has nothing to do or its time is over; it always runs once."""
    deadline = time.monotonic() + SECONDS
    while step() and time.monotonic() < deadline:
        pass


def purge_rows(services: Services) -> bool:
    """Delete a few rows of a run, finally the run itself; return False if none is due."""
    with services.sessions.write.begin() as session:
        due = (Run.purge_at.is_not(None), Run.purge_at <= clock())
        run_id = session.scalars(select(Run.id).where(*due).limit(1)).one_or_none()
        # This locks the row: a restore either came before or fails.
        run = run_id and change(session, run_id, *due, purge_at=Run.purge_at)
        if not run:
            return run_id is not None
        tables = (Elite, Result, Generation, LogEntry)
        gone = not any(_delete_some(session, run.id, table) for table in tables)
        if gone:
            _delete_run(session, run.id)
    if gone:
        services.events.publish("purge", run.id, {"run": str(run.id)})
        log.info("run %s is purged", run.id)
    return True


def collect_creatures(services: Services) -> bool:
    """Delete a few creatures of purged runs; return False if none are left to check."""
    try:
        with services.sessions.write.begin() as session:
            return collect(session)
    except IntegrityError as error:  # One has come into use meanwhile.
        log.info("will collect again: %s", error)
        return False


def remove_files(services: Services) -> bool:
    return files.remove_files(services.sessions, services.artifacts)


def _delete_some(session: Session, run_id: UUID, table: Any) -> bool:
    """Delete a few rows and mark their creatures; return False if there were none."""
    keys = inspect(table).primary_key
    rows = select(*keys).where(table.run_id == run_id).limit(ROWS_PER_TRANSACTION)
    chosen = [tuple(row) for row in session.execute(rows)]
    if not chosen:
        return False
    mine = tuple_(*keys).in_(chosen)
    if table in (Elite, Result):
        mark_garbage(session, run_id, creatures_of(table).where(mine))
    session.execute(delete(table).where(mine))
    return True


def _delete_run(session: Session, run_id: UUID) -> None:
    mark_garbage(
        session,
        run_id,
        select(InitialCreature.creature).where(InitialCreature.run_id == run_id),
        select(Choice.creature).where(Choice.run_id == run_id),
    )
    rows = delete(Artifact).where(Artifact.run_id == run_id).returning(Artifact.path)
    folder = run_folder(run_id)
    elsewhere = [path for path in session.scalars(rows) if not path.startswith(folder)]
    discard(session, [folder, *elsewhere])
    # An event that waits for the webhook outlives its run: none is lost.
    for table in (InitialCreature, Choice, Share):
        session.execute(delete(table).where(table.run_id == run_id))
    # A key stays, and says that its run was deleted.
    mine = Idempotency.run_id == run_id
    session.execute(update(Idempotency).where(mine).values(run_id=None))
    session.execute(update(Run).where(Run.forked_from == run_id).values(forked_from=None))
    session.execute(delete(Run).where(Run.id == run_id))


DAY = 86_400.0
KEY_DAYS = 30.0


def expire(services: Services) -> None:
    """Delete expired data, up to a limit; the next call continues."""
    settings = services.settings
    for keep, step in (
        (settings.keep_checkpoints, expire_checkpoints),
        (settings.keep_renderings, expire_renderings),
        (settings.keep_poses, expire_poses),
        (settings.keep_logs, expire_logs),
        (settings.keep_device_use, forget_device_time),
    ):
        if keep < math.inf:
            _repeat(partial(_expire, services, keep, step))
    forget_keys(services)
    if settings.keep_events < math.inf:
        with suppress(RedisError):  # The next search for expired data forgets them.
            services.events.forget(settings.keep_events * DAY)


def forget_keys(services: Services) -> None:
    """Delete keys of requests whose runs were deleted, once nobody repeats these."""
    alone = (Idempotency.run_id.is_(None), Idempotency.sweep.is_(None))
    with services.sessions.write.begin() as session:
        old = Idempotency.created_at < ago(session, KEY_DAYS * DAY)
        session.execute(delete(Idempotency).where(*alone, old))


def _expire(services: Services, days: float, step: Callable[[Session, datetime], int]) -> int:
    with services.sessions.write.begin() as session:
        return step(session, ago(session, days * DAY))


def expire_checkpoints(session: Session, before: datetime) -> int:
    """Delete checkpoints of runs that ended before a moment, except the last of each run."""
    later = aliased(Artifact)
    newer = (later.kind == CHECKPOINT) & (later.number > Artifact.number)
    replaced = select(later.path).where(later.run_id == Artifact.run_id, newer).exists()
    ended = select(Run.id).where(Run.status.in_(TERMINAL), Run.finished_at < before)
    return _delete(session, Artifact.kind == CHECKPOINT, replaced, Artifact.run_id.in_(ended))


def expire_renderings(session: Session, before: datetime) -> int:
    """Delete old renderings that the first request makes again."""
    return _delete(session, Artifact.kind.in_(ON_REQUEST), Artifact.created_at < before)


def expire_poses(session: Session, before: datetime) -> int:
    """Delete pose streams of creatures that are elites nowhere, once their runs have ended.

    A request makes them again, from a replay.
    """
    later, run = aliased(Elite), aliased(Run)
    of_cell = (later.run_id == Elite.run_id) & (later.cell == Elite.cell)
    replaced = select(later.cell).where(of_cell, later.generation > Elite.generation).exists()
    active = run.finished_at.is_(None) | (run.finished_at >= before)
    of_creature = select(Elite.cell).join(run, run.id == Elite.run_id)
    needed = of_creature.where(Elite.creature == Creature.sha256, ~replaced | active).exists()
    was_elite = select(Elite.cell).where(Elite.creature == Creature.sha256).exists()
    due = select(Creature.sha256).where(Creature.poses.is_not(None), was_elite, ~needed)
    found = list(session.scalars(due.limit(ROWS_PER_TRANSACTION)))
    session.execute(update(Creature).where(Creature.sha256.in_(found)).values(poses=None))
    return len(found)


def expire_logs(session: Session, before: datetime) -> int:
    """Delete log entries of runs that ended before a moment."""
    ended = select(Run.id).where(Run.status.in_(TERMINAL), Run.finished_at < before)
    due = select(LogEntry.id).where(LogEntry.run_id.in_(ended)).limit(ROWS_PER_TRANSACTION)
    found = list(session.scalars(due))
    session.execute(delete(LogEntry).where(LogEntry.id.in_(found)))
    return len(found)


def _delete(session: Session, *due: ColumnElement[bool]) -> int:
    paths = list(session.scalars(select(Artifact.path).where(*due).limit(ROWS_PER_TRANSACTION)))
    session.execute(delete(Artifact).where(Artifact.path.in_(paths)))
    discard(session, paths)
    return len(paths)
