"""Queries of elites: of all time, or of a generation."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import ColumnElement, FromClause, Select, and_, func, select

from ..core.errors import invalid_field
from ..tables import Creature, Elite, Run
from . import measures

COLUMNS = (
    *(Elite.cell, Elite.generation, Elite.fitness, Elite.descriptors, Elite.creature),
    Creature.trusted,
)


def generation_of(run: Run, asked: int | None) -> int:
    """Return a generation that the run has, its last one if none is asked for; raise
    `DomainError` for a later one."""
    if asked is not None and asked > run.generation:
        raise invalid_field(
            "generation", f"at most {run.generation}, the run's last one", asked
        )
    return run.generation if asked is None else asked


def all_time(run: Run, names: Sequence[str] = ()) -> Select[*tuple[Any, ...]]:
    """Select all elites that a run ever had, with some measures."""
    columns = [measures.column(name) for name in names]
    joined = select(*COLUMNS, *columns).join(Creature, Creature.sha256 == Elite.creature)
    return joined.where(recorded_in(run))


def emptied(run: Run, generation: int, after: int = -1) -> Select[int, int]:
    """Select cells, with the generation, that lost their elite after generation `after` and
    have no new one as of a generation."""
    entered = Elite.generation.between(after + 1, generation)
    columns = select(Elite.cell, Elite.generation)
    mine = columns.join(*_last(run, entered)).where(Elite.run_id == run.id)
    return mine.where(Elite.creature.is_(None)).order_by(Elite.cell)


def losses(run: Run) -> Select[int, int]:
    """Select all cells that lost their elite without a new one, with the generation."""
    mine = select(Elite.cell, Elite.generation).where(recorded_in(run))
    return mine.where(Elite.creature.is_(None)).order_by(Elite.generation, Elite.cell)


def recorded_in(run: Run) -> ColumnElement[bool]:
    """Return the condition for elites up to the run's generation, where a shared run ends."""
    return and_(Elite.run_id == run.id, Elite.generation <= run.generation)


def as_of(
    run: Run, generation: int, names: Sequence[str] = (), after: int = -1
) -> Select[*tuple[Any, ...]]:
    """Select each cell's elite as of a generation, if it entered after generation `after`.

    A cell whose last row has no creature is empty: the join with creatures leaves it out.
    """
    entered = Elite.generation.between(after + 1, generation)
    return all_time(run, names).join(*_last(run, entered)).order_by(Elite.cell)


def poses(run: Run, generation: int, cells: Sequence[int]) -> Select[bytes | None]:
    """Select the pose streams of the elites of some cells as of a generation."""
    entered = (Elite.generation <= generation) & Elite.cell.in_(cells)
    stored = select(Creature.poses).join(Elite, Elite.creature == Creature.sha256)
    mine = stored.join(*_last(run, entered)).where(Elite.run_id == run.id)
    return mine.order_by(Elite.cell)


def _last(run: Run, entered: ColumnElement[bool]) -> tuple[FromClause, ColumnElement[bool]]:
    """Return cell and generation of the last row of each cell, and the join's condition."""
    last = (
        select(Elite.cell, func.max(Elite.generation).label("generation"))
        .where(Elite.run_id == run.id, entered)
        .group_by(Elite.cell)
        .subquery()
    )
    return last, (Elite.cell == last.c.cell) & (Elite.generation == last.c.generation)
