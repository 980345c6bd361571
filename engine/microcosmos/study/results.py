"""The results of a finished study: records of its runs, comparisons, and aggregates."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from .. import statistics
from ..statistics import Aggregates, Group, RunRecord
from ..statistics import Comparison as Compared
from ..statistics.effects import Bootstrap
from .document import Comparison
from .runs import Plan, PlannedRun


@dataclass(frozen=True, eq=False)
class Finished:
    """A finished run, and its file."""

    run: PlannedRun
    data: bytes

    @cached_property
    def record(self) -> RunRecord:
        return statistics.read(self.data, self.run.id)

    @property
    def sha256(self) -> str:
        return hashlib.sha256(self.data).hexdigest()


@dataclass(frozen=True, eq=False)
class Compare:
    """A comparison of the study: groups, and their statistics or aggregates over tasks."""

    name: str
    groups: list[Group]
    statistics: Compared | None
    aggregates: list[Aggregates]


@dataclass(frozen=True, eq=False)
class Results:
    plan: Plan
    runs: dict[str, Finished]
    """By id, in the order of the plan."""
    comparisons: dict[str, Compare]


def gather(plan: Plan) -> Results:
    """Read the files of all runs and compare them. Raises `ValueError` as `compare` does."""
    runs = {run.id: Finished(run, run.path.read_bytes()) for run in plan.unique()}
    bootstrap = Bootstrap(plan.study.resamples)
    comparisons = {}
    for name, one in plan.study.comparisons.items():
        try:
            comparisons[name] = _compare(name, one, plan, runs, bootstrap)
        except ValueError as error:
            raise ValueError(f"comparisons.{name}: {error}") from error
    return Results(plan, runs, comparisons)


def _compare(
    name: str,
    one: Comparison,
    plan: Plan,
    runs: dict[str, Finished],
    bootstrap: Bootstrap,
) -> Compare:
    groups = _groups(one, plan, runs)
    if one.tasks:
        found = [statistics.across(groups, x, one.tasks, bootstrap) for x in one.measures]
        return Compare(name, groups, None, found)
    return Compare(name, groups, statistics.compare(groups, one.measures, bootstrap), [])


def _groups(one: Comparison, plan: Plan, runs: dict[str, Finished]) -> list[Group]:
    def records(planned: Sequence[PlannedRun]) -> list[RunRecord]:
        return [runs[run.id].record for run in planned]

    if isinstance(one.groups, dict):
        chosen = {k: records(plan.of(v.sweep, v.where)) for k, v in one.groups.items()}
        return statistics.named(chosen)
    if one.tasks:
        return statistics.named({sweep: records(plan.of(sweep, {})) for sweep in one.groups})
    return statistics.by_spec([x for sweep in one.groups for x in records(plan.of(sweep, {}))])
