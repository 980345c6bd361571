"""The order of queued runs: a fair share for each owner, and each owner's own order.

An owner's runs take turns, counted from the number of its runs that workers have: the first
turns of all owners come before all second turns. So five hundred runs of one owner delay the
single run of another by one run at most.

The database puts the runs in order: every answer about a queued run tells its place, and
reading a thousand runs for that takes longer than ordering them.
"""

from typing import Any

from sqlalchemy import (
    ColumnElement,
    Subquery,
    and_,
    case,
    false,
    func,
    literal,
    select,
    union_all,
)
from sqlalchemy.orm import Session

from ..auth.device_use import seconds_by_owner
from ..tables import HIGH, LOW, NOBODY, NORMAL, QUEUED, RUNNING, URGENT, Run

SHARE_DAYS = 7
"""Owners with equal turns go in the order of the device time they had in so many days."""
RANKS = {priority: rank for rank, priority in enumerate((URGENT, HIGH, NORMAL, LOW))}
ORDERING = (
    *(Run.id, Run.owner, Run.sweep, Run.priority, Run.interrupted, Run.queued_at),
    *(Run.created_at, Run.worker),
)
"""The columns that decide the order."""


def places(session: Session, *newcomers: Run) -> Subquery:
    """Return the `id` of each queued run with its `place`, from 1.

    Runs that workers have taken come first, then interrupted ones, then urgent ones.
    `newcomers` are runs that are not submitted; they have places as if they were.
    """
    rows = [select(*ORDERING).where(Run.status == QUEUED)]
    rows += [select(*(_literal(run, column) for column in ORDERING)) for run in newcomers]
    queued = union_all(*rows).cte("queued")
    running = select(
        func.coalesce(Run.owner, NOBODY).label("owner"), func.count().label("runs")
    )
    having = running.where(Run.status == RUNNING).group_by(Run.owner).cte("having")
    used = seconds_by_owner(session, SHARE_DAYS).cte("used")
    own = _own_order(queued.c)
    turn = func.row_number().over(partition_by=queued.c.owner, order_by=own)
    # In a join NULL equals nothing, not even NULL.
    owner = func.coalesce(queued.c.owner, NOBODY)
    turns = (
        select(
            queued,
            (func.coalesce(having.c.runs, 0) + turn).label("turn"),
            func.coalesce(used.c.seconds, 0.0).label("used"),
        )
        .outerjoin(having, having.c.owner == owner)
        .outerjoin(used, used.c.owner == owner)
        .cte("turns")
    )
    first = (turns.c.worker.is_(None), ~turns.c.interrupted, turns.c.priority != URGENT)
    order = (*first, turns.c.turn, turns.c.used, *_own_order(turns.c))
    place = func.row_number().over(order_by=order).label("place")
    return select(turns.c.id, place).subquery("places")


def _own_order(run: Any) -> tuple[ColumnElement[Any], ...]:
    """Return the sort keys of the runs of one owner: sweeps come after single runs."""
    return (
        run.worker.is_(None),
        ~run.interrupted,
        case(RANKS, value=run.priority),
        and_(run.sweep.is_not(None), run.interrupted == false()),
        # SQLite's clock counts milliseconds: runs resumed together keep their old order.
        run.queued_at,
        run.created_at,
        run.id,
    )


def _literal(run: Run, column: Any) -> ColumnElement[Any]:
    return literal(getattr(run, column.key), column.type).label(column.key)
