"""Re-projections: the elites of all creatures that ever entered, over any other axes."""

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

from sqlalchemy.orm import Session

from microcosmos.archive import principal
from microcosmos.archive.axes import of_spec
from microcosmos.archive.population import creatures
from microcosmos.archive.principal import NAME
from microcosmos.archive.reprojection import FITNESS, Reprojection, over, reproject

from ..core.errors import FieldError, ProblemError, invalid_field
from ..tables import Run
from . import elites
from .schemas import Axis, Component, Figures, ReprojectionRead


def read(
    session: Session,
    run: Run,
    axes: Sequence[str],
    more: Sequence[str],
    recorded: Sequence[str],
) -> ReprojectionRead:
    """Return the archive over axes, with columns of `more` measures.

    Raises `ProblemError` for axes that are impossible.
    """
    if unknown := [name for name in axes if name not in recorded and not _is_made(name)]:
        known = f"fitness, pc1 to pc9, or names among {', '.join(recorded)}"
        raise invalid_field("axes", known, ", ".join(unknown))
    learns = any(map(NAME.fullmatch, axes))
    named = list(dict.fromkeys((*axes, *more)))
    names = list(recorded) if learns else [name for name in named if name in recorded]
    rows = session.execute(elites.all_time(run, names)).all()
    first = len(elites.COLUMNS)
    columns = {name: [row[first + i] for row in rows] for i, name in enumerate(names)}
    listed = [row.creature for row in rows]
    given = [row.fitness for row in rows], [row.generation for row in rows], columns
    try:
        made, learned = over(creatures(listed, *given), axes, of_spec(run.spec))
    except ValueError as error:
        wrong = FieldError(field="axes", message=str(error), got=",".join(axes))
        raise ProblemError(422, "Invalid input", str(error), [wrong]) from error
    present = session.execute(elites.as_of(run, run.generation)).all()
    alone = reproject(made.creatures.among([row.creature for row in present]), made.axes)
    return ReprojectionRead(
        generation=run.generation,
        **_columns(made, rows, more),
        cells=made.count,
        axes=[Axis(**asdict(axis)) for axis in made.axes],
        components=[_component(one) for one in learned],
        all_time=_figures(made),
        present=_figures(alone),
    )


def _is_made(name: str) -> bool:
    """Return whether a name is that of an axis which is no measure."""
    return name == FITNESS or NAME.fullmatch(name) is not None


def _columns(made: Reprojection, rows: Sequence[Any], more: Sequence[str]) -> dict[str, Any]:
    """Return the wire's columns, an entry for each creature that took a cell."""
    entries = [rows[i] for i in made.creatures.given[made.entries]]
    values = {
        name: column[made.entries].tolist() for name, column in made.creatures.measures.items()
    }
    places = [values[axis.name] for axis in made.axes]
    return {
        "cell": made.cells.tolist(),
        "fitness": [row.fitness for row in entries],
        "descriptors": [list(place) for place in zip(*places, strict=True)],
        "elite_generation": [row.generation for row in entries],
        "creature": [row.creature for row in entries],
        "trusted": [row.trusted for row in entries],
        "emptied": [],
        "emptied_generation": [],
        "measures": {
            name: [value if isfinite(value) else None for value in values[name]]
            for name in more
        },
    }


def _component(one: principal.Component) -> Component:
    return Component(name=one.name, explained=one.explained, loadings=one.loadings)


def _figures(one: Reprojection) -> Figures:
    return Figures(
        creatures=len(one.creatures),
        elites=len(one.last),
        coverage=one.coverage,
        qd_score=one.qd_score,
        best=one.best,
    )
