"""Sentences that state groups, tests and corrections, and numbers as text."""

from math import comb, isinf

from ..spec.differences import value_text
from .aggregates import Aggregates
from .comparison import Comparison, Pair
from .effects import Bootstrap
from .groups import Group
from .measures import SUMS, has_negative_fitness

NOT_REACHED = "not reached"
NO_ELITES = "no elites"
NEGATIVE = (
    "Some runs have negative fitness. A QD score adds up fitness, so each elite with negative "
    "fitness lowers it: compare coverage and best fitness instead."
)
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
    return f"{value:,.0f}" if abs(value) >= 10_000 else f"{value:.4g}"


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


def groups(found: Comparison) -> str:
    """Return the fields in which groups differ, and the seeds of each."""
    names = [group.name for group in found.groups]
    counted = list(dict.fromkeys(map(seeds, found.groups)))
    if len(counted) == 1:
        each = "Each has" if len(names) > 1 else "It has"
        return f"{difference(found)} {each} {counted[0]}."
    listed = "; ".join(f"{group.name} has {seeds(group)}" for group in found.groups)
    return f"{difference(found)} {listed}."


def difference(found: Comparison) -> str:
    """Return a sentence on the groups and the fields in which their specs differ."""
    names = ", ".join(group.name for group in found.groups)
    if len(found.groups) < 2:
        return f"There is one group: {names}."
    if not found.differences:
        return f"Groups: {names}; their specs do not differ."
    parts = [
        f"{path} ({', '.join(map(value_text, values))})"
        for path, values in found.differences.items()
    ]
    more = len(parts) - MAX_FIELDS
    rest = f"; and {more} more fields" if more > 0 else ""
    shown = "; ".join(parts[:MAX_FIELDS])
    return f"Groups: {names}; their specs differ, in this order, in {shown}{rest}."


def method(found: Comparison) -> str:
    """Return the tests, the correction, and how intervals are made."""
    if found.refusal:
        return f"Median and quartiles over seeds. {found.refusal}"
    return (
        f"Median and quartiles over seeds. {tested(found)} IQM is the mean of the middle half "
        f"of the runs; it and A12 with {resampled(found.bootstrap)}."
    )


def tested(found: Comparison) -> str:
    """Return the tests, the correction and the effect size, or why there are none."""
    if found.refusal:
        return found.refusal
    several, count = len(found.groups) > 2, found.tests
    overall = "Kruskal–Wallis tests over all groups, not corrected. " if several else ""
    between = "pairs of groups" if several else "the groups"
    plural = "test" if count == 1 else "tests"
    return (
        f"{overall}Two-sided {tests(found)} between {between}; p after Holm’s correction for "
        f"{count} {plural}. A12 (Vargha and Delaney) is the share of pairs of runs in which "
        "the first group’s value is greater."
    )


def tests(found: Comparison) -> str:
    names = {pair.test.name for result in found.results for pair in result.pairs}
    forms = {name.partition(", ")[2] for name in names} - {""}
    stated = f" ({' or '.join(sorted(forms))})" if forms else ""
    return f"Mann–Whitney tests{stated}"


def resampled(bootstrap: Bootstrap) -> str:
    return (
        f"95 % percentile bootstrap intervals ({bootstrap.resamples:,} resamples, "
        f"seed {bootstrap.seed})"
    )


def results(found: Comparison) -> str:
    """Return the corrected p and A12 of every pair, for captions; of many pairs, of those that
    differ."""
    many = found.tests > MAX_PAIRS
    said = []
    for result in found.results:
        shown = [pair for pair in result.pairs if not many or pair.p < LEVEL]
        if shown:
            title = f"{result.measure.title[0].upper()}{result.measure.title[1:]}"
            said.append(f"{title}: {'; '.join(map(_pair, shown))}.")
    if many:
        said.append(f"All other pairs have p ≥ {LEVEL:g}.")
    return " ".join(said)


def _pair(pair: Pair) -> str:
    p = probability(pair.p)
    equals = p if p.startswith("<") else f"= {p}"
    return f"{pair.first} against {pair.second}, p {equals}, A12 = {pair.superiority:.2f}"


def cautions(found: Comparison) -> list[str]:
    """Return what a reader should know: other versions or devices, few values of p, runs
    without elites, and sums of negative fitness."""
    said = []
    if len(found.versions) > 1:
        said.append(f"Runs are of several versions: {', '.join(found.versions)}.")
    kinds = dict.fromkeys(
        d for group in found.groups for run in group.runs for d in run.devices
    )
    if len(kinds) > 1:
        said.append(f"Runs are of {len(kinds)} kinds of devices.")
    if (least := _least(found)) > LEVEL:
        said.append(
            f"With these numbers of runs and {found.tests} tests, no p can be below "
            f"{least:.3f}: add seeds or name fewer measures."
        )
    if any(result.measure.less_is_better for result in found.results):
        said.append(
            "Fewer evaluations to a value are better; a run that does not reach it counts as "
            "more than any other."
        )
    values = [x for r in found.results for one in r.summaries for x in one.values]
    if float("-inf") in values:
        said.append(
            "A run without elites has no best or mean fitness, and counts as less than any "
            "other."
        )
    if any(result.measure.curve in SUMS for result in found.results) and any(
        has_negative_fitness(run) for group in found.groups for run in group.runs
    ):
        said.append(NEGATIVE)
    return said


def _least(found: Comparison) -> float:
    """Return the least corrected p that a pair can have: of two groups that do not overlap."""
    if found.refusal:
        return 0.0
    first, second = sorted(len(group.runs) for group in found.groups)[-2:]
    return min(1.0, found.tests * 2 / comb(first + second, first))


def aggregated(found: Aggregates) -> str:
    """Return how aggregates over tasks are made, and over which."""
    tasks = ", ".join(
        " and ".join(f"{path} {value_text(value)}" for path, value in task.items())
        for task in found.tasks
    )
    count = "1 task" if len(found.tasks) == 1 else f"{len(found.tasks)} tasks"
    first = found.groups[0].group
    said = [
        f"Over {count} ({tasks}); scores are relative to the median of "
        f"{first} in the task. IQM is the mean of the middle half of all runs, and "
        "P(first > second) the mean over tasks of the share of pairs of runs."
    ]
    if found.refusal:
        return f"{said[0]} {found.refusal}"
    drawn = f"Stratified {resampled(found.bootstrap)}: each task’s runs are drawn again"
    return f"{said[0]} {drawn} (Agarwal et al. 2021)."
