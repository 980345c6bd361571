"""Plans of studies: the runs, and checks of comparisons and figures before a run begins."""

from collections.abc import Container, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from math import ceil, inf
from pathlib import Path

import numpy as np

from .. import statistics
from ..archive.curves import CORRECTED, CURVES
from ..invalid import InvalidField
from ..optional import require
from ..spec import Evolution, estimate
from ..statistics import Group, Measure, RunRecord
from ..statistics.aggregates import by_task
from ..statistics.effects import Bootstrap
from ..statistics.groups import differences, refuse_wrong
from ..version import VERSION
from ..viz.figures import compared, style
from .document import Comparison, Figure, Study
from .results import groups_of
from .runs import Plan, PlannedRun, refuse_path, runs_of, shown

FEW = Bootstrap(resamples=99)


def plan(study: Study, folder: Path, beside: Path) -> Plan:
    """Return the runs of a study; `beside` is the folder of files with specs.

    Raises `ValueError`, which names the field, for specs, comparisons and figures that are
    wrong as far as specs tell, and `ImportError` for figures without the extra `figures`.
    """
    planned = runs_of(study, folder, beside)
    runs = planned.unique()
    records = {run.id: _foreseen(run) for run in runs}
    vague = {records[run.id].name for run in runs if not _has_known_end(run.spec)}
    groups: dict[str, list[Group]] = {}
    for name, one in study.comparisons.items():
        with _within(f"comparisons.{name}"):
            groups[name] = groups_of(one, planned, records)
        _check_comparison(f"comparisons.{name}", one, groups[name], vague)
    if study.figures:
        require("matplotlib")
    for number, figure in enumerate(study.figures):
        _check_figure(f"figures.{number}", figure, groups[study.comparison_of(figure)[0]])
    return planned


@contextmanager
def _within(field: str) -> Iterator[None]:
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{field}: {error}") from error


def _foreseen(run: PlannedRun) -> RunRecord:
    """Return the record of a run as far as its spec tells: the first and the last generation,
    in which all values are 1. With re-evaluation it has all generations, and corrected values
    where elites are evaluated again, or everywhere if the end is not known."""
    batch, again = run.spec.search.batch, run.spec.search.reevaluation
    if again:
        batch += sum(run.spec.gradients)
        end = _generations(run.spec) if _has_known_end(run.spec) else None
        evaluations, ones, known = _reevaluated(batch, again.every, _generations(run.spec), end)
    else:
        evaluations = np.array([batch, _evaluations(run.spec)])
        ones = known = np.ones(2)
    curves = {name: ones for name in CURVES if name not in CORRECTED}
    curves |= {"evaluations": evaluations}
    if again:
        curves |= dict.fromkeys(CORRECTED, known)
    case = ", ".join(filter(None, [shown(run.values), f"seed {run.spec.seed}"]))
    document = run.spec.model_dump(mode="json")
    return RunRecord(f"{run.sweep} ({case})", document, curves, VERSION, (), "finished")


@cache
def _reevaluated(
    batch: int, every: int, generations: int, end: int | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return evaluations, ones, and ones where elites are evaluated again, for all generations.

    Up to a thousand runs of up to a million generations share them.
    """
    numbers = np.arange(1, generations + 1)
    known = (numbers % every == 0) | (numbers == end) | (end is None)
    return numbers * batch, np.ones(generations), np.where(known, 1.0, np.nan)


def _has_known_end(spec: Evolution) -> bool:
    """Return whether all runs of a spec end after as many evaluations."""
    search = spec.search
    stop = search.stop
    limited = stop.fitness is not None or stop.device_hours is not None
    # A limit of evaluations counts those of elites again.
    limited |= search.reevaluation is not None and stop.evaluations is not None
    return not (limited or any(spec.gradients))


def _evaluations(spec: Evolution) -> int:
    """Return the evaluations at the end of a run, or the most where the end is not known."""
    if not _has_known_end(spec):
        return estimate(spec).evaluations
    return spec.search.batch * _generations(spec)


def _generations(spec: Evolution) -> int:
    """Return the generations of a run, or the most where the end is not known."""
    batch, most = spec.search.batch, spec.search.stop.evaluations or inf
    return min(spec.search.generations, ceil(min(most, 1e18) / batch))


def _check_comparison(
    field: str, one: Comparison, groups: Sequence[Group], vague: Container[str]
) -> None:
    """Raise `ValueError` where runs as foreseen cannot be compared.

    `vague` are the names of runs whose ends are not known: these refuse no comparison.
    """
    runs = [run for group in groups for run in group.runs]
    for path in one.tasks:
        for run in runs:
            refuse_path(run.document, path, f"{field}.tasks")
    with _within(field):
        refuse_wrong(groups, one.tasks)
    with _within(f"{field}.measures"):
        for measure in map(Measure.parse, one.measures):
            for run in runs:
                measure.of(run)
            if one.tasks:
                by_task(groups, measure, one.tasks)
        if any(run.name in vague for run in runs):
            return
        if one.tasks:
            for text in one.measures:
                statistics.across(groups, text, one.tasks, FEW)
        else:
            # Runs of a group have one spec, and so few need no bootstrap.
            firsts = [Group(group.name, group.runs[:1]) for group in groups]
            statistics.compare(firsts, one.measures, FEW)


def _check_figure(field: str, figure: Figure, groups: Sequence[Group]) -> None:
    if figure.kind in ("curves", "box", "profile"):
        with _within(field):
            for group in groups:
                style.drawable(group.name)
    if figure.kind == "curves":
        runs = [run for group in groups for run in group.runs]
        common = [name for name in runs[0].curves if all(name in run.curves for run in runs)]
        for name in figure.shown:
            if name not in common:
                listed = ", ".join(common)
                raise InvalidField(f"{field}.shown", f"must be of {listed}; got {name!r}")
    if figure.kind == "sheet":
        # The fittest run, which is drawn, may be any of them.
        for run in (run for group in groups for run in group.runs):
            if (axes := len(run.spec.archive.descriptors)) < 2:
                raise ValueError(
                    f"{field}: a figure `sheet` needs at least two `archive.descriptors`, got "
                    f"{axes} in {run.name}"
                )
    if figure.kind == "parameter":
        with _within(f"{field}.field"):
            differing = differences(groups)
            made = statistics.Comparison(tuple(groups), (), "", FEW, differing)
            compared.series(made, figure.field)
