"""Queries of elites: of all time, or of a generation."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import ColumnElement, FromClause, Select, and_, func, select

from ..tables import Creature, Elite, Run
from . import measures

COLUMNS = (
    *(Elite.cell, Elite.generation, Elite.fitness, Elite.descriptors, Elite.creature),
    Creature.trusted,
)


def all_time(run: Run, names: Sequence[str] = ()) -> Select[*tuple[Any, ...]]:
    """Select a run's elites, also those that were replaced, with measures by name."""
    columns = [measures.column(name) for name in names]
    joined = select(*COLUMNS, *columns).join(Creature, Creature.sha256 == Elite.creature)
    return joined.where(recorded_in(run))


def recorded_in(run: Run) -> ColumnElement[bool]:
    """Return the condition for elites up to the run's generation, where a shared run ends."""
    return and_(Elite.run_id == run.id, Elite.generation <= run.generation)


def as_of(
    run: Run, generation: int, names: Sequence[str] = (), after: int = -1
) -> Select[*tuple[Any, ...]]:
    """Select each cell's elite as of a generation, if it entered after generation `after`."""
    entered = Elite.generation.between(after + 1, generation)
    return all_time(run, names).join(*_last(run, entered)).order_by(Elite.cell)


def poses(run: Run, generation: int, cells: Sequence[int]) -> Select[bytes | None]:
    """Select the pose stream, if any, of the elite of each of some cells as of a generation."""
    entered = (Elite.generation <= generation) & Elite.cell.in_(cells)
    stored = select(Creature.poses).join(Elite, Elite.creature == Creature.sha256)
    mine = stored.join(*_last(run, entered)).where(Elite.run_id == run.id)
    return mine.order_by(Elite.cell)


def _last(run: Run, entered: ColumnElement[bool]) -> tuple[FromClause, ColumnElement[bool]]:
    """Return cell and generation of the last elite of each cell, and the join's condition."""
    last = (
        select(Elite.cell, func.max(Elite.generation).label("generation"))
        .where(Elite.run_id == run.id, entered)
        .group_by(Elite.cell)
        .subquery()
    )
    return last, (Elite.cell == last.c.cell) & (Elite.generation == last.c.generation)
