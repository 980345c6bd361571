"""Read an archive, its history or a re-projection from the database."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from math import isfinite
from threading import Lock
from typing import Any

import numpy as np
from sqlalchemy import Select, func, select
from sqlalchemy.orm import Session

from microcosmos.archive.axes import of_spec
from microcosmos.archive.learned import LearnedAxes, learned_axes
from microcosmos.archive.population import creatures
from microcosmos.archive.principal import NAME
from microcosmos.archive.reprojection import FITNESS, Reprojection, over, reproject
from microcosmos.invalid import InvalidField

from ..core.errors import FieldError, Invalid, invalid_field
from ..runs.curves import coverage_at
from ..services.services import Services
from ..storage import segments
from ..tables import Artifact, Elite, Run
from . import elites
from . import measures as recorded_measures
from .schemas import (
    ArchiveRead,
    Axis,
    Component,
    Figures,
    HistoryRead,
    Measure,
    ReprojectionRead,
)

Values = Mapping[str, Sequence[float | None]]


@dataclass(frozen=True)
class LearnedMeasures:
    """The coordinates of elites along learned axes."""

    axes: LearnedAxes
    bins: int

    @property
    def names(self) -> list[str]:
        return [f"learned_{i + 1}" for i in range(len(self.axes.explained))]

    @property
    def described(self) -> list[Measure]:
        """Return the measures; they come before others as axes of a map."""
        parts = zip(self.names, self.axes.explained, self.axes.ends, strict=True)
        return [
            Measure(
                name=name,
                title=f"Learned axis {i + 1} ({100 * share:.0f} % of the variance)",
                unit="",
                low=float(low),
                high=float(high),
                scale="linear",
                bins=self.bins,
            )
            for i, (name, share, (low, high)) in enumerate(parts)
        ]

    def columns(self, values: Values) -> dict[str, list[float]]:
        """Return the coordinates by name, from columns of the measures that make the axes."""
        rows = [[np.nan if x is None else x for x in values[one]] for one in self.axes.measures]
        found = self.axes.places(np.array(rows, float).T)
        return {name: found[:, i].tolist() for i, name in enumerate(self.names)}


def learned_of(services: Services, run: Run, file: Artifact | None) -> LearnedMeasures | None:
    """Return the learned axes of a run's file; None if it has none."""
    container = run.spec["archive"].get("container") or {}
    if container.get("kind") != "learned" or file is None:
        return None
    if segments.whole(file).size > segments.LARGEST:
        return None
    found = _axes.get(services, file)
    return None if found is None else LearnedMeasures(found, container["bins"])


class _KeptAxes:
    """Learned axes by the hash of their file, which may be large, and is read once."""

    def __init__(self, number: int):
        self._number = number
        self._kept = dict[str, LearnedAxes | None]()
        self._reading = Lock()

    def get(self, services: Services, file: Artifact) -> LearnedAxes | None:
        sha = segments.whole(file).sha256
        with suppress(KeyError):
            return self._kept[sha]
        with self._reading:  # One file at a time is in memory.
            if sha not in self._kept:
                try:
                    self._kept[sha] = learned_axes(segments.read(services.artifacts, file))
                except ValueError:  # It ended before any axes were learned.
                    self._kept[sha] = None
            while len(self._kept) > self._number:
                self._kept.pop(next(iter(self._kept)))
            return self._kept[sha]


_axes = _KeptAxes(64)


def stored_names(names: Sequence[str], learned: LearnedMeasures | None) -> list[str]:
    """Return the stored measures that are needed for some measures."""
    if learned is None or not set(names) & set(learned.names):
        return list(names)
    plain = [name for name in names if name not in learned.names]
    return list(dict.fromkeys((*plain, *learned.axes.measures)))


HISTORY_ENTRIES, HISTORY_VALUES = 400_000, 4_000_000
"""Limits on a history: some 100 MB of JSON. An entry has five values and its measures."""


def archive(
    session: Session,
    services: Services,
    run: Run,
    file: Artifact | None,
    generation: int | None,
    after: int | None,
    measures: str,
) -> ArchiveRead:
    """Return the elite of each cell; with `after`, only elites that entered later.

    `file` tells the learned axes.
    """
    as_of = elites.generation_of(run, generation)
    own = learned_of(services, run, file)
    recorded = _recorded(session, run, own)
    names = _requested(measures, recorded)
    known = -1 if after is None else min(after, run.generation)
    kind, cells = recorded_measures.kind(run)
    return ArchiveRead(
        generation=as_of,
        kind=kind,
        cells=cells,
        axes=recorded_measures.axes(run),
        recorded=recorded,
        coverage=coverage_at(session, run.id, as_of),
        **_columns(session, lambda stored: elites.as_of(run, as_of, stored, known), names, own),
        **_emptied(session, elites.emptied(run, as_of, known)),
    )


def history(
    session: Session, services: Services, run: Run, file: Artifact | None, measures: str
) -> HistoryRead:
    """Return every elite that ever entered; raise `DomainError` for too many."""
    own = learned_of(services, run, file)
    names = _requested(measures, _recorded(session, run, own))
    most = min(HISTORY_ENTRIES, HISTORY_VALUES // (5 + len(names)))
    _refuse_long(session, run, most)

    def ordered(stored: Sequence[str]) -> Select[*tuple[Any, ...]]:
        return elites.all_time(run, stored).order_by(Elite.generation, Elite.cell)

    columns = _columns(session, ordered, names, own)
    columns |= _emptied(session, elites.losses(run))
    return HistoryRead(generation=run.generation, **columns)


def reprojected(session: Session, run: Run, axes: str, measures: str) -> ReprojectionRead:
    """Return the archive over other axes; raise `DomainError` for impossible ones."""
    recorded = recorded_measures.recorded(session, run)
    names, more = list(filter(None, axes.split(","))), _requested(measures, recorded)
    _refuse_long(session, run, HISTORY_ENTRIES)
    return _reproject(session, run, names, more, [one.name for one in recorded])


def _requested(measures: str, recorded: Sequence[Measure]) -> list[str]:
    """Return the requested measures in the order in which they are recorded."""
    names = list(filter(None, measures.split(",")))
    existing = [measure.name for measure in recorded]
    if wrong := [name for name in names if name not in existing]:
        raise invalid_field("measures", f"names among {', '.join(existing)}", ", ".join(wrong))
    return [name for name in existing if name in names]


def _refuse_long(session: Session, run: Run, most: int) -> None:
    counted = select(func.count()).select_from(Elite).where(elites.recorded_in(run))
    entries = session.execute(counted).scalar_one()
    if entries > most:
        detail = (
            f"The history of this archive has {entries:,} entries, more than the {most:,} that "
            "one answer with these measures holds. Read single generations at "
            f"/api/v1/runs/{run.id}/archive?generation=."
        )
        raise Invalid(detail, title="History too long")


def _recorded(session: Session, run: Run, own: LearnedMeasures | None) -> list[Measure]:
    return [*(own.described if own else []), *recorded_measures.recorded(session, run)]


def _columns(
    session: Session,
    select_with: Callable[[Sequence[str]], Select[*tuple[Any, ...]]],
    names: Sequence[str],
    own: LearnedMeasures | None,
) -> dict[str, Any]:
    """Return the wire's columns; `select_with` selects elites with stored measures."""
    stored, first = stored_names(names, own), len(elites.COLUMNS)
    found = session.execute(select_with(stored)).all()
    values = {name: [elite[first + i] for elite in found] for i, name in enumerate(stored)}
    if own and set(names) & set(own.names):
        values |= own.columns(values)
    return {
        "cell": [elite.cell for elite in found],
        "fitness": [elite.fitness for elite in found],
        "descriptors": [elite.descriptors for elite in found],
        "elite_generation": [elite.generation for elite in found],
        "creature": [elite.creature for elite in found],
        "trusted": [elite.trusted for elite in found],
        "measures": {name: values[name] for name in names},
    }


def _emptied(session: Session, found: Select[int, int]) -> dict[str, Any]:
    rows = session.execute(found).all()
    cells, generations = [row.cell for row in rows], [row.generation for row in rows]
    return {"emptied": cells, "emptied_generation": generations}


def _reproject(
    session: Session,
    run: Run,
    axes: Sequence[str],
    more: Sequence[str],
    recorded: Sequence[str],
) -> ReprojectionRead:
    """Return the archive over axes, with columns of `more` measures.

    Raises `DomainError` for axes that are impossible.
    """
    made_axes = [name for name in axes if name == FITNESS or NAME.fullmatch(name)]
    if unknown := [name for name in axes if name not in (*recorded, *made_axes)]:
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
        reason = error.reason if isinstance(error, InvalidField) else str(error)
        wrong = FieldError(field="axes", reason=reason, got=",".join(axes))
        raise Invalid(str(error), [wrong]) from error
    present = session.execute(elites.as_of(run, run.generation)).all()
    alone = reproject(made.creatures.among([row.creature for row in present]), made.axes)
    return ReprojectionRead(
        generation=run.generation,
        **_entries(made, rows, more),
        cells=made.count,
        axes=[Axis(**asdict(axis)) for axis in made.axes],
        components=[Component.model_validate(one) for one in learned],
        all_time=_figures(made),
        present=_figures(alone),
    )


def _entries(made: Reprojection, rows: Sequence[Any], more: Sequence[str]) -> dict[str, Any]:
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


def _figures(one: Reprojection) -> Figures:
    return Figures(
        creatures=len(one.creatures),
        elites=len(one.last),
        coverage=one.coverage,
        qd_score=one.qd_score,
        best=one.best,
    )
