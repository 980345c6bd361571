"""What the runs of a sweep say together: medians and quartiles by generation, and at last."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

import numpy as np
from sqlalchemy import select
from sqlalchemy.orm import Session

from ..runs.lifecycle import KEPT
from ..runs.overview import evenly
from ..tables import Generation, Run, Sweep
from .comparison import FIGURES, common_generation, figures_at
from .schemas import (
    CaseSummary,
    Final,
    Quantiles,
    RunCurves,
    SweepCurves,
    SweepRun,
    SweepSummary,
)
from .steering import combinations

QUANTILES = {"median": 0.5, "low": 0.25, "high": 0.75, "min": 0.0, "max": 1.0}
POINTS = 400_000
"""Values of each figure that are looked at for one answer."""
NAMED = 10_000
"""Generations that one question to the database names."""
OF_RUNS = ("id", "sweep_index", "status", "generation", "generations")

Told = Any
"""A row of the columns that were asked for."""
Values = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Recorded:
    """The curves of all runs of a sweep, over the same generations."""

    runs: Sequence[Told]
    """In the order of their places."""
    generation: list[int]
    reached: np.ndarray[Any, np.dtype[np.bool_]]
    """Run by generation: whether it has got so far."""
    values: Mapping[str, Values]
    """Of each figure, run by generation; NaN where there is none."""


def recorded(session: Session, sweep: Sweep, points: int | None) -> Recorded:
    """All generations, or about so many, and fewer where all would be too much."""
    columns = [getattr(Run, name) for name in OF_RUNS]
    mine = select(*columns).where(Run.sweep == sweep.id, KEPT).order_by(Run.sweep_index)
    runs = session.execute(mine).all()
    last = max((run.generation for run in runs), default=0)
    most = max(2, POINTS // max(1, len(runs)))
    wanted = points or last
    generation = evenly(last, wanted if wanted <= most else min(most, NAMED))
    return Recorded(runs, generation, *_table(session, sweep, runs, generation, last))


def _table(
    session: Session,
    sweep: Sweep,
    runs: Sequence[Told],
    generation: Sequence[int],
    last: int,
) -> tuple[Any, dict[str, Values]]:
    """The rows of all runs in one question, put where they belong."""
    columns = [getattr(Generation, name) for name in FIGURES]
    asked = select(Run.sweep_index, Generation.generation, *columns).join(
        Run, Run.id == Generation.run_id
    )
    # Runs may have gone on since they were read, or have come back from the bin.
    asked = asked.where(
        Run.sweep == sweep.id, Run.sweep_index.in_([run.sweep_index for run in runs])
    )
    asked = asked.where(Generation.generation <= last)
    if len(generation) < last:
        asked = asked.where(Generation.generation.in_(generation))
    found = session.execute(asked).all()
    shape = (len(runs), len(generation))
    reached = np.zeros(shape, bool)
    values = np.full((len(FIGURES), *shape), np.nan)
    if found:
        place, at, *told = zip(*found, strict=True)
        row = np.searchsorted([run.sweep_index for run in runs], place)
        column = np.searchsorted(generation, at)
        reached[row, column] = True
        values[:, row, column] = np.array(told, float)  # None becomes NaN.
    return reached, dict(zip(FIGURES, values, strict=True))


def summary(session: Session, sweep: Sweep, points: int | None) -> SweepSummary:
    """Each case by itself."""
    found = recorded(session, sweep, points)
    values = combinations(sweep.grid)
    of_case = np.array([run.sweep_index for run in found.runs], int) % len(values)
    seeds = [seed for seed in sweep.seeds or [None] for _ in values]
    members = [_member(run, seeds[run.sweep_index]) for run in found.runs]
    common = common_generation(found.runs)
    figures = figures_at(session, found.runs, common, "search" in sweep.spec)
    cases = [
        _case(found, np.flatnonzero(of_case == number), members, figures, told)
        for number, told in enumerate(values)
    ]
    return SweepSummary(id=sweep.id, generation=common, cases=cases)


def _case(
    found: Recorded,
    mine: Any,
    members: Sequence[SweepRun],
    figures: Mapping[UUID, Mapping[str, float]],
    values: dict[str, Any],
) -> CaseSummary:
    """What some of the runs say together, as far as any of them has got."""
    counts = found.reached[mine].sum(0)
    there = counts > 0
    bands = {
        name: _band(table[np.ix_(mine, np.flatnonzero(there))])
        for name, table in found.values.items()
    }
    return CaseSummary(
        values=values,
        members=[members[row] for row in mine],
        generation=[g for g, told in zip(found.generation, there, strict=True) if told],
        runs=counts[there].tolist(),
        **bands,
        finals=finals([figures.get(members[row].run, {}) for row in mine]),
    )


def _member(run: Told, seed: int | None) -> SweepRun:
    return SweepRun(
        run=run.id,
        seed=seed,
        status=run.status,
        generation=run.generation,
        generations=run.generations,
    )


def _band(values: Values) -> Quantiles:
    return Quantiles(**{name: told(column) for name, column in spread(values).items()})


def spread(values: Values) -> dict[str, Values]:
    """The quantiles of each column, those of its values that are none left aside."""
    if not values.size:
        return {name: np.full(values.shape[1], np.nan) for name in QUANTILES}
    ordered = np.sort(values, axis=0)  # NaN goes last.
    last = np.maximum(0, (~np.isnan(values)).sum(0) - 1)
    return {name: _quantile(ordered, last * share) for name, share in QUANTILES.items()}


def _quantile(ordered: Values, place: Values) -> Values:
    """Between two of the values in proportion, where the place is between two."""
    below, above = (
        np.take_along_axis(ordered, side(place).astype(int)[None], 0)[0]
        for side in (np.floor, np.ceil)
    )
    return below + (above - below) * (place - np.floor(place))


def told(column: Values) -> list[float | None]:
    return [None if value != value else value for value in column.tolist()]


def finals(figures: Sequence[Mapping[str, float]]) -> dict[str, Final]:
    """Each figure of some runs, with its quantiles."""
    names = dict.fromkeys(name for one in figures for name in one)
    return {name: _final([one.get(name) for one in figures]) for name in names}


def _final(values: Iterable[float | None]) -> Final:
    known = np.array(list(values), float)
    quantiles = {name: told(one)[0] for name, one in spread(known[:, None]).items()}
    return Final(values=told(known), **quantiles)


def curves(session: Session, sweep: Sweep, points: int | None) -> SweepCurves:
    """Each run by itself, over the same generations."""
    found = recorded(session, sweep, points)
    lines = [
        RunCurves(run=run.id, **{name: told(table[i]) for name, table in found.values.items()})
        for i, run in enumerate(found.runs)
    ]
    return SweepCurves(generation=found.generation, runs=lines)
