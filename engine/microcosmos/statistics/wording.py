"""Sentences that state groups, tests and corrections, and numbers as text."""

from collections.abc import Mapping, Sequence
from math import comb, isinf
from typing import Any

from ..archive.curves import SUMS
from ..spec.paths import value_text, value_texts
from .aggregates import Aggregates
from .comparison import Comparison, Pair
from .effects import Bootstrap
from .groups import Group, devices, differences
from .measures import Measure, has_negative_fitness

NOT_REACHED = "not reached"
NO_ELITES = "no elites"
NEGATIVE = (
    "Some runs have negative fitness. A QD score adds up fitness, so each elite with negative "
    "fitness lowers it: compare coverage and best fitness instead."
)
APART = "Evaluations of elites again (`search.reevaluation`) are not counted."
MAX_FIELDS = 6
"""Fields in which specs differ that a sentence names."""
MAX_PAIRS = 12
"""Pairs that a caption states one by one."""
LEVEL = 0.05
"""p below which a caption of more pairs states them, and that tests should be able to reach."""


def number(value: float) -> str:
    """Return a number with four digits; infinity is a value that a run does not reach, minus
    infinity the fitness of an archive without elites."""
    if isinf(value):
        return NOT_REACHED if value > 0 else NO_ELITES
    text = f"{value:.4g}"
    return f"{value:,.0f}" if abs(float(text)) >= 10_000 else text


def interval(ends: tuple[float, float] | None) -> str:
    return "" if ends is None else f"{number(ends[0])} to {number(ends[1])}"


def probability(p: float) -> str:
    """Return p as text, `< 0.001` where it is less."""
    return "< 0.001" if p < 0.001 else f"{p:.3f}"


def seeds(group: Group) -> str:
    """Return the number of runs and the seeds, as `n = 5, seeds 0 to 4`."""
    numbers = group.seeds
    first, last = numbers[0], numbers[-1]
    together = len(numbers) > 2 and numbers == list(range(first, last + 1))
    listed = f"{first} to {last}" if together else ", ".join(map(str, numbers))
    plural = "seed" if len(numbers) == 1 else "seeds"
    return f"n = {len(group.runs)}, {plural} {listed}"


def groups(comparison: Comparison) -> str:
    """Return the fields in which groups differ, and the seeds of each."""
    return described(comparison.groups)


def described(groups: Sequence[Group]) -> str:
    """Return the fields in which groups differ, and the seeds of each."""
    differ = _differ([group.name for group in groups], differences(groups))
    counted = list(dict.fromkeys(map(seeds, groups)))
    if len(counted) == 1:
        each = "Each has" if len(groups) > 1 else "It has"
        return f"{differ} {each} {counted[0]}."
    listed = "; ".join(f"{group.name} has {seeds(group)}" for group in groups)
    return f"{differ} {listed}."


def difference(comparison: Comparison) -> str:
    """Return a sentence on the groups and the fields in which their specs differ."""
    return _differ([group.name for group in comparison.groups], comparison.differences)


def _differ(groups: Sequence[str], fields: Mapping[str, Sequence[Any]]) -> str:
    names = ", ".join(groups)
    if len(groups) < 2:
        return f"There is one group: {names}."
    if not fields:
        return f"Groups: {names}; their specs do not differ."
    parts = [f"{path} ({', '.join(value_texts(values))})" for path, values in fields.items()]
    more = len(parts) - MAX_FIELDS
    rest = f"; and {more} more {'field' if more == 1 else 'fields'}" if more > 0 else ""
    shown = "; ".join(parts[:MAX_FIELDS])
    return f"Groups: {names}; their specs differ, in this order, in {shown}{rest}."


def method(comparison: Comparison) -> str:
    """Return the tests, the correction, and how intervals are made."""
    if comparison.refusal:
        return f"Median and quartiles over seeds. {comparison.refusal}"
    return (
        f"Median and quartiles over seeds. {tested(comparison)} IQM is the mean of the middle "
        f"half of the runs; it and A12 with {resampled(comparison.bootstrap)}."
    )


def tested(comparison: Comparison) -> str:
    """Return the tests, the correction and the effect size, or why there are none."""
    if comparison.refusal:
        return comparison.refusal
    several, count = len(comparison.groups) > 2, comparison.tests
    overall = "Kruskal–Wallis tests over all groups, not corrected. " if several else ""
    between = "pairs of groups" if several else "the groups"
    plural = "test" if count == 1 else "tests"
    return (
        f"{overall}Two-sided {tests(comparison)} between {between}; p after Holm’s correction "
        f"for {count} {plural}. A12 (Vargha and Delaney) is the share of pairs of runs in "
        "which the first group’s value is greater."
    )


def tests(comparison: Comparison) -> str:
    names = {pair.test.name for result in comparison.results for pair in result.pairs}
    forms = {name.partition(", ")[2] for name in names} - {""}
    stated = f" ({' or '.join(sorted(forms))})" if forms else ""
    return f"Mann–Whitney tests{stated}"


def resampled(bootstrap: Bootstrap) -> str:
    return (
        f"95 % percentile bootstrap intervals ({bootstrap.resamples:,} resamples, "
        f"seed {bootstrap.seed})"
    )


def results(comparison: Comparison) -> str:
    """Return the corrected p and A12 of every pair, for captions; of many pairs, of those that
    differ."""
    many = comparison.tests > MAX_PAIRS
    sentences = []
    for result in comparison.results:
        shown = [pair for pair in result.pairs if not many or pair.p < LEVEL]
        if shown:
            title = f"{result.measure.title[0].upper()}{result.measure.title[1:]}"
            sentences.append(f"{title}: {'; '.join(map(_pair, shown))}.")
    if many:
        sentences.append(f"All other pairs have p ≥ {LEVEL:g}.")
    return " ".join(sentences)


def _pair(pair: Pair) -> str:
    p = probability(pair.p)
    equals = p if p.startswith("<") else f"= {p}"
    return f"{pair.first} against {pair.second}, p {equals}, A12 = {pair.superiority:.2f}"


def cautions(comparison: Comparison) -> list[str]:
    """Return warnings: several versions or devices, few runs, evaluations apart, no elites,
    negative fitness."""
    sentences = machines(comparison.versions, devices(comparison.groups))
    if (least := _least(comparison)) > LEVEL:
        sentences.append(
            f"With these numbers of runs and {comparison.tests} tests, no p can be below "
            f"{least:.3f}: add seeds or name fewer measures."
        )
    if any(result.measure.less_is_better for result in comparison.results):
        sentences.append(
            "Fewer evaluations to a value are better; a run that does not reach it counts as "
            "more than any other."
        )
    runs = [run for group in comparison.groups for run in group.runs]
    measures = [result.measure for result in comparison.results]
    sentences += [APART] * (any(run.is_reevaluated for run in runs) and _counts(measures))
    values = [x for r in comparison.results for one in r.summaries for x in one.values]
    if float("-inf") in values:
        sentences.append(
            "A run without elites has no best or mean fitness, and counts as less than any "
            "other."
        )
    shown = [result.measure.curve for result in comparison.results]
    return sentences + negative(shown, comparison.groups)


def _counts(measures: Sequence[Measure]) -> bool:
    """Return whether measures have numbers of evaluations."""
    return any(one.at is not None or one.reaches is not None for one in measures)


def negative(shown: Sequence[str], groups: Sequence[Group]) -> list[str]:
    """Return a warning if curves add up fitness, and runs have negative fitness."""
    runs = [run for group in groups for run in group.runs]
    adds_up = any(name in SUMS for name in shown)
    return [NEGATIVE] * (adds_up and any(map(has_negative_fitness, runs)))


def machines(versions: Sequence[str], devices: Sequence[str]) -> list[str]:
    """Return warnings of several versions, and of several kinds of device."""
    sentences = []
    if len(versions) > 1:
        sentences.append(f"Runs are of several versions: {', '.join(versions)}.")
    if len(devices) > 1:
        sentences.append(f"Runs are of {len(devices)} kinds of devices.")
    return sentences


def _least(comparison: Comparison) -> float:
    """Return the least corrected p that a pair can have: of two groups that do not overlap."""
    if comparison.refusal:
        return 0.0
    first, second = sorted(len(group.runs) for group in comparison.groups)[-2:]
    return min(1.0, comparison.tests * 2 / comb(first + second, first))


def aggregated(aggregates: Aggregates, *others: Aggregates) -> str:
    """Return the groups, the method, the tasks and the cautions of aggregates of groups, which
    may be of several measures."""
    names = [group.group for group in aggregates.groups]
    differ = _differ(names, aggregates.differences)
    cautions = cautions_over_tasks([aggregates, *others])
    return " ".join([differ, _over_tasks(aggregates), *cautions])


def cautions_over_tasks(several: Sequence[Aggregates]) -> list[str]:
    """Return warnings: several versions or devices, evaluations apart, negative fitness."""
    negative = any(one.negative_fitness and one.measure.curve in SUMS for one in several)
    again = several[0].reevaluated and _counts([one.measure for one in several])
    sentences = machines(several[0].versions, several[0].devices)
    return sentences + [APART] * again + [NEGATIVE] * negative


def _over_tasks(aggregates: Aggregates) -> str:
    tasks = ", ".join(
        " and ".join(f"{path} {value_text(value)}" for path, value in task.items())
        for task in aggregates.tasks
    )
    count = "1 task" if len(aggregates.tasks) == 1 else f"{len(aggregates.tasks)} tasks"
    first = aggregates.groups[0].group
    sentences = [
        f"Over {count} ({tasks}); scores are relative to the median of "
        f"{first} in the task. IQM is the mean of the middle half of all runs, and "
        "P(first > second) the mean over tasks of the share of pairs of runs."
    ]
    if aggregates.refusal:
        return f"{sentences[0]} {aggregates.refusal}"
    drawn = f"Stratified {resampled(aggregates.bootstrap)}: each task’s runs are drawn again"
    return f"{sentences[0]} {drawn} (Agarwal et al. 2021)."
