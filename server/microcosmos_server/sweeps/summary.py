"""Statistics of a sweep: quantiles by generation, and figures at the common generation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

import numpy as np
from sqlalchemy import case, select
from sqlalchemy.orm import Session

from microcosmos.archive.curves import CORRECTED
from microcosmos.archive.report import curves_of
from microcosmos.spec.paths import combinations

from ..runs.curves import thinned
from ..runs.lifecycle import NOT_IN_BIN
from ..runs.overview import faces_of
from ..tables import CANCELLED, FAILED, FINISHED, Generation, Run, Sweep
from .schemas import (
    CaseSummary,
    Final,
    Quantiles,
    RunCurves,
    SweepCurves,
    SweepRun,
    SweepSummary,
)

FIGURES = ("qd_score", "coverage", "best")
COLUMNS = (*FIGURES, "evaluations")
QUANTILES = {"median": 0.5, "low": 0.25, "high": 0.75, "min": 0.0, "max": 1.0}
POINTS = 400_000
"""Limit on the values of each figure that one answer reads."""
GENERATIONS_PER_QUERY = 10_000

Values = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Recorded:
    """The curves of all runs of a sweep, over the same generations."""

    runs: Sequence[Any]
    """In the order of their places."""
    generation: list[int]
    reached: np.ndarray[Any, np.dtype[np.bool_]]
    """Run by generation: the run has recorded it."""
    values: Mapping[str, Values]
    """Each figure, run by generation; NaN where there is none."""


def recorded(session: Session, sweep: Sweep, points: int | None) -> Recorded:
    """Read all generations, or about `points` of them; fewer for very many runs."""
    names = ("id", "sweep_index", "status", "generation", "generations", "best")
    columns = [getattr(Run, name) for name in names]
    mine = select(*columns).where(Run.sweep == sweep.id, NOT_IN_BIN).order_by(Run.sweep_index)
    runs = session.execute(mine).all()
    last = max((run.generation for run in runs), default=0)
    most = max(2, POINTS // max(1, len(runs)))
    wanted = points or last
    generation = thinned(last, wanted if wanted <= most else min(most, GENERATIONS_PER_QUERY))
    return Recorded(runs, generation, *_table(session, sweep, runs, generation, last))


def _table(
    session: Session,
    sweep: Sweep,
    runs: Sequence[Any],
    generation: Sequence[int],
    last: int,
) -> tuple[Any, dict[str, Values]]:
    columns = [getattr(Generation, name) for name in FIGURES]
    # Runs may have continued since they were read, or have come back from the bin.
    wanted = (
        select(Run.sweep_index, Generation.generation, *columns)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.sweep == sweep.id, Run.sweep_index.in_([run.sweep_index for run in runs]))
        .where(Generation.generation <= last)
    )
    if len(generation) < last:
        wanted = wanted.where(Generation.generation.in_(generation))
    found = session.execute(wanted).all()
    shape = (len(runs), len(generation))
    reached = np.zeros(shape, bool)
    values = np.full((len(FIGURES), *shape), np.nan)
    if found:
        place, at, *figures = zip(*found, strict=True)
        row = np.searchsorted([run.sweep_index for run in runs], place)
        column = np.searchsorted(generation, at)
        reached[row, column] = True
        values[:, row, column] = np.array(figures, float)  # None becomes NaN.
    return reached, dict(zip(FIGURES, values, strict=True))


def summary(session: Session, sweep: Sweep, points: int | None) -> SweepSummary:
    found = recorded(session, sweep, points)
    cases = combinations(sweep.grid)
    of_case = np.array([run.sweep_index for run in found.runs], int) % len(cases)
    seeds = [seed for seed in sweep.seeds or [None] for _ in cases]
    faces = faces_of(session, found.runs)
    members = [
        SweepRun(
            run=run.id,
            seed=seeds[run.sweep_index],
            status=run.status,
            generation=run.generation,
            generations=run.generations,
            face=faces.get(run.id),
            best=run.best,
        )
        for run in found.runs
    ]
    common = common_generation(found.runs)
    figures = figures_at(session, found.runs, common, "search" in sweep.spec)
    summaries = [
        _case(found, np.flatnonzero(of_case == number), members, figures, values)
        for number, values in enumerate(cases)
    ]
    return SweepSummary(id=sweep.id, generation=common, cases=summaries)


def _case(
    found: Recorded,
    mine: Any,
    members: Sequence[SweepRun],
    figures: Mapping[UUID, Mapping[str, float]],
    values: dict[str, Any],
) -> CaseSummary:
    """Summarise some of the runs, up to the last generation that any has recorded."""
    counts = found.reached[mine].sum(0)
    columns = np.flatnonzero(counts > 0)
    quantiles = {
        name: Quantiles(
            **{key: _plain(one) for key, one in spread(table[np.ix_(mine, columns)]).items()}
        )
        for name, table in found.values.items()
    }
    return CaseSummary(
        values=values,
        members=[members[row] for row in mine],
        generation=[found.generation[column] for column in columns],
        runs=counts[columns].tolist(),
        **quantiles,
        finals=finals([figures.get(members[row].run, {}) for row in mine]),
    )


def spread(values: Values) -> dict[str, Values]:
    """Return the quantiles of each column, ignoring NaN."""
    if not values.size:
        return {name: np.full(values.shape[1], np.nan) for name in QUANTILES}
    ordered = np.sort(values, axis=0)  # NaN goes last.
    last = np.maximum(0, (~np.isnan(values)).sum(0) - 1)
    return {name: _quantile(ordered, last * share) for name, share in QUANTILES.items()}


def _quantile(ordered: Values, place: Values) -> Values:
    """Interpolate linearly between two of the values."""
    below, above = (
        np.take_along_axis(ordered, side(place).astype(int)[None], 0)[0]
        for side in (np.floor, np.ceil)
    )
    return below + (above - below) * (place - np.floor(place))


def _plain(column: Values) -> list[float | None]:
    return [None if value != value else value for value in column.tolist()]


def finals(figures: Sequence[Mapping[str, float]]) -> dict[str, Final]:
    found: dict[str, Final] = {}
    for name in dict.fromkeys(name for one in figures for name in one):
        known = np.array([one.get(name) for one in figures], float)
        quantiles = {key: _plain(one)[0] for key, one in spread(known[:, None]).items()}
        found[name] = Final(values=_plain(known), **quantiles)
    return found


def common_generation(runs: Sequence[Any]) -> int | None:
    """Return the last generation that every started run has reached; None before the first.

    A finished run counts as complete, so it does not limit the generation. Failed and
    cancelled runs count only if no other run is active or finished.
    """
    started = [run for run in runs if run.generation > 0]
    active = [run for run in started if run.status not in (FINISHED, FAILED, CANCELLED)]
    finished = [run.generation for run in started if run.status == FINISHED]
    if not active and finished:
        return max(finished)
    return min((run.generation for run in active or started), default=None)


def figures_at(
    session: Session, runs: Sequence[Any], generation: int | None, has_archive: bool
) -> dict[UUID, dict[str, float]]:
    """Return the figures of each run at a generation; of a shorter finished run the last ones.

    The figures of the corrected archive are included if elites were reevaluated in that
    generation. A run whose result is a table adds the numbers of its newest summary.
    """
    if generation is None:
        return {}
    compared = [
        run.id for run in runs if run.generation >= generation or run.status == FINISHED
    ]
    last = case((Run.generation < generation, Run.generation), else_=generation)
    at = Generation.generation == last if has_archive else Generation.generation <= last
    columns = [getattr(Generation, name) for name in COLUMNS]
    rows = (
        select(Generation.run_id, *columns, Generation.summary)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.id.in_(compared), at)
        .order_by(Generation.generation)
    )
    found: dict[UUID, dict[str, float]] = {}
    for run_id, *values, summary in session.execute(rows):
        figures = dict(zip(COLUMNS, values, strict=True))
        known = {name: value for name, value in figures.items() if value is not None}
        numbers = curves_of(summary)
        if has_archive:
            numbers = {name: numbers[name] for name in CORRECTED if name in numbers}
        found[run_id] = {**found.get(run_id, {}), **known, **numbers}
    return found


def curves(session: Session, sweep: Sweep, points: int | None) -> SweepCurves:
    found = recorded(session, sweep, points)
    lines = [
        RunCurves(run=run.id, **{name: _plain(one[i]) for name, one in found.values.items()})
        for i, run in enumerate(found.runs)
    ]
    return SweepCurves(generation=found.generation, runs=lines)
