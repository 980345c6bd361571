"""Compare groups of runs: quartiles, rank tests with Holm's correction, effect sizes."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import numpy as np

from ..invalid import InvalidField
from .effects import (
    Bootstrap,
    Test,
    holm,
    kruskal_wallis,
    mann_whitney,
    middle_mean,
    quartiles,
    superiority,
)
from .groups import Group, differences, refuse_wrong, versions
from .measures import DEFAULT, Measure, advice, apart, parsed, refuse_other_schedules
from .records import RunRecord

FEWEST = 5
"""Runs that each group needs for tests and intervals."""


@dataclass(frozen=True)
class Summary:
    """One measure of the runs of a group."""

    group: str
    values: tuple[float, ...]
    """In the order of the group's runs; infinite where a run does not reach the value, minus
    infinity where it has no elites."""
    low: float
    median: float
    high: float
    middle_mean: float
    """The interquartile mean."""
    interval: tuple[float, float] | None
    """95 % bootstrap interval of the interquartile mean; None without tests, and where an end
    is infinite."""

    @property
    def count(self) -> int:
        return len(self.values)


@dataclass(frozen=True)
class Pair:
    """Two groups beside each other in one measure."""

    first: str
    second: str
    test: Test
    p: float
    """After Holm's correction for all pairs of all measures."""
    superiority: float
    """A12: the share of pairs of runs in which the first group's value is greater."""
    interval: tuple[float, float]


@dataclass(frozen=True)
class Result:
    """One measure of all groups."""

    measure: Measure
    summaries: tuple[Summary, ...]
    overall: Test | None
    """The test of all groups; None for two."""
    pairs: tuple[Pair, ...]


@dataclass(frozen=True)
class Comparison:
    groups: tuple[Group, ...]
    results: tuple[Result, ...]
    refusal: str
    """The reason why there are no tests; empty if there are."""
    bootstrap: Bootstrap
    differences: dict[str, list[Any]] = field(default_factory=dict)
    """Fields in which the specs of groups differ, each with the value of every group."""

    @property
    def tests(self) -> int:
        """Return the number of tests for which p is corrected."""
        return sum(len(result.pairs) for result in self.results)

    @property
    def versions(self) -> tuple[str, ...]:
        return versions(self.groups)


def compare(
    groups: Sequence[Group],
    measures: Sequence[Measure | str] = DEFAULT,
    bootstrap: Bootstrap | None = None,
) -> Comparison:
    """Compare groups of runs by measures.

    Groups of fewer than five runs get quartiles, and a sentence in place of tests. Raises
    `ValueError` for a run that is unfinished or in two groups, for a group that has a seed
    twice or differs in more than the seed, and for runs compared at unequal evaluations.
    """
    # Wrong groups first: their measures may not even exist.
    refuse_wrong(groups)
    bootstrap = bootstrap or Bootstrap()
    distinct = parsed(measures)
    if not distinct:
        raise InvalidField("measures", "needs at least one measure, got none")
    runs = [run for group in groups for run in group.runs]
    for measure in distinct:
        _refuse_unequal(runs, measure)
        refuse_other_schedules(runs, measure)
    refusal = too_few(groups)
    results = [_result(groups, measure, not refusal, bootstrap) for measure in distinct]
    return Comparison(
        tuple(groups), _corrected(results), refusal, bootstrap, differences(groups)
    )


def too_few(groups: Sequence[Group]) -> str:
    """Return the reason for no tests: too few groups, or too few runs in one; else ""."""
    if len(groups) < 2:
        return f"Tests need at least 2 groups, got {len(groups)}."
    short = [group for group in groups if len(group.runs) < FEWEST]
    if not short:
        return ""
    counts = ", ".join(f"{len(group.runs)} in {group.name!r}" for group in short)
    return f"Tests need at least {FEWEST} seeds in each group, got {counts}."


def _refuse_unequal(runs: Sequence[RunRecord], measure: Measure) -> None:
    """Raise `ValueError` if the number of evaluations alone could order the runs."""
    if measure.reaches is not None:
        return _refuse_early(runs, measure)
    if measure.at is not None:
        return None
    # Reversed, so that a message names the first run with each number.
    ends = {int(run.searched[-1]): run for run in reversed(runs)}
    if len(ends) < 2:
        return None
    low, high = min(ends), max(ends)
    raise InvalidField(
        f"{measure.text}",
        f"needs runs with equal evaluations{apart(runs)}, got {low:,} in {ends[low].name} "
        f"and {high:,} in {ends[high].name}{advice(runs, measure)}",
    )


def _refuse_early(runs: Sequence[RunRecord], measure: Measure) -> None:
    """Raise `ValueError` if a run ended before another one reached the value.

    With more evaluations it might have been the earlier of the two.
    """
    reached = [(measure.of(run), run) for run in runs]
    missing = [run for at, run in reached if at == np.inf]
    finite = [one for one in reached if one[0] < np.inf]
    if not missing or not finite:
        return
    short = min(missing, key=lambda run: run.searched[-1])
    latest, other = max(finite, key=lambda one: one[0])
    if (end := short.searched[-1]) < latest:
        raise InvalidField(
            f"{measure.text}",
            f"needs equal evaluations{apart(runs)} where a run does not reach the value, "
            f"got {short.name}, which ended at {end:,.0f} evaluations without reaching it, and "
            f"{other.name}, which reached it at {latest:,.0f}",
        )


def _result(
    groups: Sequence[Group], measure: Measure, tested: bool, bootstrap: Bootstrap
) -> Result:
    values = [np.array([measure.of(run) for run in group.runs]) for group in groups]
    summaries = tuple(
        _summary(group, one, tested, bootstrap)
        for group, one in zip(groups, values, strict=True)
    )
    if not tested:
        return Result(measure, summaries, None, ())
    pairs = tuple(
        _pair((groups[i].name, values[i]), (groups[j].name, values[j]), bootstrap)
        for i, j in combinations(range(len(groups)), 2)
    )
    overall = kruskal_wallis(values) if len(groups) > 2 else None
    return Result(measure, summaries, overall, pairs)


def _summary(group: Group, values: np.ndarray, tested: bool, bootstrap: Bootstrap) -> Summary:
    low, median, high = quartiles(values)
    interval = bootstrap.interval([values], middle_mean) if tested else (np.nan, np.nan)
    return Summary(
        group=group.name,
        values=tuple(values.tolist()),
        low=low,
        median=median,
        high=high,
        middle_mean=float(middle_mean(values)),
        interval=interval if np.isfinite(interval).all() else None,
    )


def _pair(
    first: tuple[str, np.ndarray], second: tuple[str, np.ndarray], bootstrap: Bootstrap
) -> Pair:
    (name, ours), (other, theirs) = first, second
    test = mann_whitney(ours, theirs)
    share = float(superiority(ours, theirs))
    interval = bootstrap.interval([ours, theirs], superiority, len(ours) * len(theirs))
    return Pair(name, other, test, test.p, share, interval)


def _corrected(results: Sequence[Result]) -> tuple[Result, ...]:
    """Return the results with p of all pairs corrected for their number."""
    # All pairs of all measures are one family of tests (docs/statistics.md).
    corrected = iter(holm([pair.test.p for result in results for pair in result.pairs]))
    return tuple(
        replace(one, pairs=tuple(replace(pair, p=next(corrected)) for pair in one.pairs))
        for one in results
    )
