"""The results of a finished study: records of its runs, comparisons, and exports."""

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from .. import statistics
from ..archive import export
from ..archive.file import load
from ..archive.poses import streams
from ..statistics import Aggregates, Group, RunRecord, tables
from ..statistics import Comparison as Compared
from ..statistics.effects import Bootstrap
from ..statistics.measures import parsed
from .document import Comparison, file_of
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
    records = {id: one.record for id, one in runs.items()}
    for run in plan.unique():
        with run.named():
            run.refuse_other(records[run.id].document)
    bootstrap = Bootstrap(plan.study.resamples)
    comparisons = {}
    for name, one in plan.study.comparisons.items():
        try:
            comparisons[name] = _compare(name, one, plan, records, bootstrap)
        except ValueError as error:
            raise ValueError(f"comparisons.{name}: {error}") from error
    return Results(plan, runs, comparisons)


def _compare(
    name: str,
    one: Comparison,
    plan: Plan,
    records: Mapping[str, RunRecord],
    bootstrap: Bootstrap,
) -> Compare:
    groups = groups_of(one, plan, records)
    if one.tasks:
        measures = parsed(one.measures)
        aggregates = [statistics.across(groups, x, one.tasks, bootstrap) for x in measures]
        return Compare(name, groups, None, aggregates)
    return Compare(name, groups, statistics.compare(groups, one.measures, bootstrap), [])


def groups_of(one: Comparison, plan: Plan, records: Mapping[str, RunRecord]) -> list[Group]:
    """Return the groups of a comparison; `records` are those of its runs by their ids."""

    def of(sweep: str, where: Mapping[str, Any]) -> list[RunRecord]:
        return [records[run.id] for run in plan.of(sweep, where)]

    if isinstance(one.groups, dict):
        return statistics.named({k: of(v.sweep, v.where) for k, v in one.groups.items()})
    if one.tasks:
        return statistics.named({sweep: of(sweep, {}) for sweep in one.groups})
    # Sweeps may have runs in common, which are one run each.
    runs = {run.id: run for sweep in one.groups for run in plan.of(sweep, {})}
    return statistics.by_spec([records[id] for id in runs])


Files = dict[str, bytes]


def exports(results: Results) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the exports that the study lists, by their names."""
    for name in results.plan.study.exports:
        yield from _EXPORTS[name](results).items()


def _table(suffix: str, write: Callable[..., str]) -> Callable[[Results], Files]:
    """Return an export of every comparison; those over tasks are JSON alone."""

    def made(results: Results) -> Files:
        files: Files = {}
        for name, one in results.comparisons.items():
            if one.statistics:
                files[f"{file_of(name)}.{suffix}"] = write(one.statistics).encode()
            elif suffix == "json":
                files[f"{file_of(name)}.json"] = tables.aggregates_json(one.aggregates).encode()
        return files

    return made


def _archives(results: Results) -> Files:
    """Return pyribs' table of every archive."""
    return {f"archives/{id}.csv": export.csv(x.data).encode() for id, x in results.runs.items()}


def _poses(results: Results) -> Files:
    """Return the poses of the fittest creature of every run that has elites."""
    files = {}
    for id, one in results.runs.items():
        tree, attributes = load(one.data)
        fitness = tree["archive"]["fitness"]
        # A run may end without an elite
        # (test_runs_without_elites_have_no_poses_and_an_empty_table).
        if len(fitness):
            best = streams(tree, attributes)[int(np.argmax(fitness))]
            files[f"poses/{id}.npz"] = best.npz()
    return files


_EXPORTS: dict[str, Callable[[Results], Files]] = {
    "csv": _table("csv", tables.csv),
    "json": _table("json", tables.json),
    "latex": _table("tex", tables.latex),
    "archive-csv": _archives,
    "poses-npz": _poses,
}
