"""Retention: delete what is older than the settings say, a little at a time."""

import math
from collections.abc import Callable
from datetime import datetime

from sqlalchemy import ColumnElement, delete, select, update
from sqlalchemy.orm import Session, aliased

from ..auth.device_use import forget_device_time
from ..core.database import ago
from ..renderings.responses import ON_REQUEST
from ..services.services import Services
from ..storage.garbage import discard
from ..tables import CHECKPOINT, TERMINAL, Artifact, Creature, Elite, LogEntry, Run

DAY = 86_400.0
ROWS_PER_TRANSACTION, STEPS = 500, 200


def expire(services: Services) -> None:
    """Delete all that is due, up to a limit; the next call goes on."""
    settings = services.settings
    for keep, step in (
        (settings.keep_checkpoints, expire_checkpoints),
        (settings.keep_renderings, expire_renderings),
        (settings.keep_poses, expire_poses),
        (settings.keep_logs, expire_logs),
        (settings.keep_device_use, forget_device_time),
    ):
        if keep < math.inf:
            _repeat(services, keep, step)
    if settings.keep_events < math.inf:
        services.events.forget(settings.keep_events * DAY)


def _repeat(services: Services, days: float, step: Callable[[Session, datetime], int]) -> None:
    for _ in range(STEPS):
        with services.sessions.write.begin() as session:
            if not step(session, ago(session, days * DAY)):
                return


def expire_checkpoints(session: Session, before: datetime) -> int:
    """Delete checkpoints of runs that ended before, but the last of each: it is the result."""
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
    once = select(Elite.cell).where(Elite.creature == Creature.sha256).exists()
    due = select(Creature.sha256).where(Creature.poses.is_not(None), once, ~needed)
    found = list(session.scalars(due.limit(ROWS_PER_TRANSACTION)))
    session.execute(update(Creature).where(Creature.sha256.in_(found)).values(poses=None))
    return len(found)


def expire_logs(session: Session, before: datetime) -> int:
    """Delete log entries of runs that ended before."""
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
