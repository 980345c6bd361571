"""The order of queued runs: a fair share for each owner, and each owner's own order.

An owner's runs take turns, counted from the number of its runs that workers have: the first
turns of all owners come before all second turns. So five hundred runs of one owner delay the
single run of another by one run at most.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any
from uuid import UUID

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..auth.device_use import device_seconds
from ..tables import HIGH, LOW, NORMAL, QUEUED, RUNNING, URGENT, Run

ORDERING = (
    *(Run.id, Run.owner, Run.sweep, Run.priority, Run.interrupted, Run.queued_at),
    *(Run.created_at, Run.worker),
)
"""What decides about the place of a queued run."""
COLUMNS = (
    *ORDERING,
    *(Run.avoided_worker, Run.plugin_versions, Run.labels, Run.memory_bytes, Run.device),
    *(Run.device_patience, Run.checkpoint_generation, Run.released_at),
)
"""What decides which worker may take it, too."""
SHARE_DAYS = 7
"""Owners with equal turns go in the order of the device time they had in so many days."""
RANKS = {priority: rank for rank, priority in enumerate((URGENT, HIGH, NORMAL, LOW))}


def in_order(session: Session, *newcomers: Run, columns: Sequence[Any] = COLUMNS) -> list[Any]:
    """Return columns of the queued runs in their order, those that workers have first.

    `newcomers` are runs that are not submitted; they are ordered as if they were.
    """
    queued: Sequence[Any] = session.execute(select(*columns).where(Run.status == QUEUED)).all()
    if len(queued) + len(newcomers) < 2:
        return [*queued, *newcomers]
    running = select(Run.owner, func.count()).where(Run.status == RUNNING).group_by(Run.owner)
    turns = {owner: number for owner, number in session.execute(running)}
    return ordered([*queued, *newcomers], turns, device_seconds(session, SHARE_DAYS))


def ordered(
    queued: Sequence[Any], turns: Mapping[UUID | None, int], used: Mapping[UUID | None, float]
) -> list[Any]:
    """Order runs, given the number of running runs and the device seconds of each owner.

    Taken runs come first, then interrupted ones, then urgent ones.
    """
    next_turn, placed = Counter(turns), []
    for own, run in sorted(((_own_order(run), run) for run in queued), key=itemgetter(0)):
        turn, next_turn[run.owner] = next_turn[run.owner], next_turn[run.owner] + 1
        first = (run.worker is None, not run.interrupted, run.priority != URGENT)
        placed.append(((*first, turn, used.get(run.owner, 0.0), *own), run))
    return [run for _, run in sorted(placed, key=itemgetter(0))]


def _own_order(run: Any) -> tuple[Any, ...]:
    """Return the key that orders the runs of one owner: sweeps after single runs."""
    return (
        run.worker is None,
        not run.interrupted,
        RANKS[run.priority],
        run.sweep is not None and not run.interrupted,
        # SQLite's clock counts milliseconds: runs resumed together keep their old order.
        run.queued_at,
        run.created_at,
        run.id,
    )
