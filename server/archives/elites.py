"""Who lives in a run's archive: now, at a generation, and ever."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import ColumnElement, Select, and_, func, select

from ..tables import Creature, Elite, Run
from . import measures

COLUMNS = (
    Elite.cell,
    Elite.generation,
    Elite.fitness,
    Elite.descriptors,
    Elite.creature,
)


def ever(run: Run, names: Sequence[str] = ()) -> Select[*tuple[Any, ...]]:
    """A run's elites, past ones too, and their measures by name."""
    columns = [measures.column(name) for name in names]
    statement = select(*COLUMNS, *columns).where(until_now(run))
    return statement.join(Creature, Creature.sha256 == Elite.creature) if names else statement


def until_now(run: Run) -> ColumnElement[bool]:
    """One that was shared is seen as it was, though it may have gone on."""
    return and_(Elite.run_id == run.id, Elite.generation <= run.generation)


def at(
    run: Run, generation: int, names: Sequence[str] = (), after: int = -1
) -> Select[*tuple[Any, ...]]:
    """The last of each cell that is not after a generation, of those that came `after` one."""
    last = (
        select(Elite.cell, func.max(Elite.generation).label("generation"))
        .where(Elite.run_id == run.id, Elite.generation.between(after + 1, generation))
        .group_by(Elite.cell)
        .subquery()
    )
    same = (Elite.cell == last.c.cell) & (Elite.generation == last.c.generation)
    return ever(run, names).join(last, same).order_by(Elite.cell)
