"""Aggregates over several tasks, as in rliable: the interquartile mean, the probability
of improvement, and performance profiles.

Agarwal, Schwarzer, Castro, Courville and Bellemare, NeurIPS 2021, arXiv:2108.13264.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import rfc8785

from ..invalid import InvalidField
from .comparison import FEWEST
from .effects import Bootstrap, middle_mean, superiority
from .groups import Group, devices, differences, refuse_wrong, versions
from .measures import Measure, advice, apart, has_negative_fitness, refuse_other_schedules
from .records import RunRecord

POINTS = 101
"""Scores at which a performance profile is drawn."""


@dataclass(frozen=True)
class Aggregate:
    """A group over all tasks; scores are relative to the first group's median of the task."""

    group: str
    runs: int
    middle_mean: float
    interval: tuple[float, float] | None
    """95 % stratified bootstrap interval; None with fewer than five runs of a task."""
    profile: tuple[float, ...]
    """Share of runs with a greater score, at each of the aggregates' `scores`."""
    band: tuple[tuple[float, ...], tuple[float, ...]] | None
    """95 % stratified bootstrap interval of the profile."""


@dataclass(frozen=True)
class Improvement:
    """The probability that a run of the first group is greater, mean over tasks."""

    first: str
    second: str
    probability: float
    interval: tuple[float, float] | None


@dataclass(frozen=True)
class Aggregates:
    measure: Measure
    tasks: tuple[dict[str, Any], ...]
    """The values of the tasks' fields."""
    groups: tuple[Aggregate, ...]
    improvements: tuple[Improvement, ...]
    scores: tuple[float, ...]
    refusal: str
    bootstrap: Bootstrap
    differences: dict[str, list[Any]]
    """Fields other than the tasks' in which the specs of groups differ."""
    versions: tuple[str, ...]
    devices: tuple[str, ...]
    """Versions and kinds of device of all runs."""
    negative_fitness: bool
    reevaluated: bool
    """Whether some runs evaluate their elites again."""


def across(
    groups: Sequence[Group],
    measure: Measure | str,
    tasks: Sequence[str],
    bootstrap: Bootstrap | None = None,
) -> Aggregates:
    """Aggregate groups over tasks, which are the values of some fields of the spec.

    Raises `ValueError` as `compare` does, and where a group lacks a task or has unequal numbers
    of runs, or where the median by which scores are divided is not above 0.
    """
    refuse_wrong(groups, tasks)
    bootstrap = bootstrap or Bootstrap()
    measure = Measure.parse(measure) if isinstance(measure, str) else measure
    split = by_task(groups, measure, tasks)
    _refuse_unequal(groups, split, measure)
    keys = list(split[0])
    scores = _scores(split, keys, measure)
    refusal = _too_few(groups, split)
    most = max(float(np.max(one)) for group in scores for one in group)
    along = np.linspace(0.0, most, POINTS)
    aggregates = tuple(
        _aggregate(group.name, one, along, not refusal, bootstrap)
        for group, one in zip(groups, scores, strict=True)
    )
    improvements = tuple(
        _improvement(
            (groups[i].name, scores[i]), (groups[j].name, scores[j]), not refusal, bootstrap
        )
        for i, j in combinations(range(len(groups)), 2)
    )
    named = tuple({path: split[0][key][0].fields[path] for path in tasks} for key in keys)
    return Aggregates(
        measure=measure,
        tasks=named,
        groups=aggregates,
        improvements=improvements,
        scores=tuple(along.tolist()),
        refusal=refusal,
        bootstrap=bootstrap,
        differences=differences(groups, tasks),
        versions=versions(groups),
        devices=devices(groups),
        negative_fitness=any(has_negative_fitness(run) for one in groups for run in one.runs),
        reevaluated=any(run.is_reevaluated for one in groups for run in one.runs),
    )


Split = Mapping[tuple[str, ...], list[RunRecord]]
"""Runs by the values of the tasks' fields as canonical JSON, since some values are lists."""


def by_task(groups: Sequence[Group], measure: Measure, tasks: Sequence[str]) -> list[Split]:
    """Return the runs of each group by task.

    Raises `ValueError` for a measure that has no value in each run, and where a group lacks a
    task or has unequal numbers of runs.
    """
    if measure.reaches is not None:
        raise ValueError(f"aggregates need the value of a curve, got {measure.text!r}")
    split = [_by_task(group, tasks) for group in groups]
    first = split[0]
    for group, one in zip(groups, split, strict=True):
        if set(one) != set(first):
            raise ValueError(
                f"every group needs the same tasks, got {_listed(first)} in "
                f"{groups[0].name!r} and {_listed(one)} in {group.name!r}"
            )
        if len({len(runs) for runs in one.values()}) > 1:
            counts = ", ".join(str(len(runs)) for runs in one.values())
            raise ValueError(
                f"group {group.name!r} needs as many runs of every task, got {counts}"
            )
    return split


def _by_task(group: Group, tasks: Sequence[str]) -> Split:
    found: dict[tuple[str, ...], list[RunRecord]] = {}
    for run in group.runs:
        missing = [path for path in tasks if path not in run.fields]
        if missing:
            raise ValueError(f"{run.name}: the spec has no field `{missing[0]}` for tasks")
        # 1 and 1.0 are one task (test_numbers_of_tasks_are_equal_in_any_form).
        found.setdefault(
            tuple(rfc8785.dumps(run.fields[path]).decode() for path in tasks), []
        ).append(run)
    return found


def _refuse_unequal(groups: Sequence[Group], split: Sequence[Split], measure: Measure) -> None:
    for task in split[0]:
        runs = [run for one in split for run in one[task]]
        refuse_other_schedules(runs, measure)
        ends = {int(run.searched[-1]) for run in runs}
        if measure.at is None and len(ends) > 1:
            everywhere = [run for group in groups for run in group.runs]
            raise InvalidField(
                f"{measure.text}",
                f"needs runs with equal evaluations{apart(runs)} in a task, got "
                f"{min(ends):,} and {max(ends):,}{advice(everywhere, measure)}",
            )


def _listed(tasks: Split) -> str:
    return "; ".join(sorted(", ".join(values) for values in tasks))


def _scores(
    split: Sequence[Split], keys: Sequence[tuple[str, ...]], measure: Measure
) -> list[list[np.ndarray]]:
    """Return scores by group, task and run, relative to the first group's median."""
    for run in (run for one in split for key in keys for run in one[key]):
        if np.isinf(measure.of(run)):
            raise InvalidField(
                f"{measure.text}", f"needs elites in every run, got none in {run.name}"
            )
    raw = [[np.array([measure.of(run) for run in one[key]]) for key in keys] for one in split]
    scales = [float(np.median(values)) for values in raw[0]]
    if wrong := [scale for scale in scales if scale <= 0]:
        raise ValueError(
            "scores are relative to the first group's median of each task, which must be "
            f"above 0, got {wrong[0]:g}"
        )
    return [[x / s for x, s in zip(one, scales, strict=True)] for one in raw]


def _too_few(groups: Sequence[Group], split: Sequence[Split]) -> str:
    counts = {
        group.name: len(next(iter(one.values())))
        for group, one in zip(groups, split, strict=True)
    }
    short = [f"{n} in {name!r}" for name, n in counts.items() if n < FEWEST]
    if not short:
        return ""
    return f"Intervals need at least {FEWEST} seeds of each task, got {', '.join(short)}."


def _aggregate(
    name: str,
    scores: Sequence[np.ndarray],
    along: np.ndarray,
    tested: bool,
    bootstrap: Bootstrap,
) -> Aggregate:
    profile = _profile(along)(*scores)
    return Aggregate(
        group=name,
        runs=sum(map(len, scores)),
        middle_mean=float(middle_mean(*scores)),
        interval=bootstrap.interval(scores, middle_mean) if tested else None,
        profile=tuple(profile.tolist()),
        band=_band(scores, along, bootstrap) if tested else None,
    )


def _profile(along: np.ndarray) -> Callable[..., np.ndarray]:
    def share(*samples: np.ndarray, axis: int = -1) -> np.ndarray:
        together = np.concatenate(samples, axis=axis)
        return np.stack([(together > score).mean(axis) for score in along])

    return share


def _band(
    scores: Sequence[np.ndarray], along: np.ndarray, bootstrap: Bootstrap
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return pointwise intervals of the profile: each task's runs are drawn again."""
    rng = np.random.default_rng(bootstrap.seed)
    drawn = [
        one[rng.integers(len(one), size=(bootstrap.resamples, len(one)))] for one in scores
    ]
    together = np.concatenate(drawn, axis=-1)
    # One score after another: with many resamples all shares together take gigabytes.
    bands = [np.quantile((together > one).mean(-1), (0.025, 0.975)) for one in along]
    low, high = np.transpose(bands)
    return tuple(low.tolist()), tuple(high.tolist())


def _improvement(
    first: tuple[str, Sequence[np.ndarray]],
    second: tuple[str, Sequence[np.ndarray]],
    tested: bool,
    bootstrap: Bootstrap,
) -> Improvement:
    (name, ours), (other, theirs) = first, second
    tasks = len(ours)

    def mean(*samples: np.ndarray, axis: int = -1) -> np.ndarray:
        pairs = zip(samples[:tasks], samples[tasks:], strict=True)
        return np.mean([superiority(x, y, axis) for x, y in pairs], axis=0)

    samples = [*ours, *theirs]
    pairs = max(len(x) * len(y) for x, y in zip(ours, theirs, strict=True))
    interval = bootstrap.interval(samples, mean, pairs) if tested else None
    return Improvement(name, other, float(mean(*samples)), interval)
