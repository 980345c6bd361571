"""Groups of runs that are compared, checked for wrong use, and in what their specs differ."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..spec.differences import IGNORED, MAX_FIELDS, differing, label, value_text
from .records import RunRecord


@dataclass(frozen=True, eq=False)
class Group:
    """Runs that differ in their seed alone, or also in the fields of tasks."""

    name: str
    runs: tuple[RunRecord, ...]

    @property
    def seeds(self) -> list[int]:
        return sorted({run.seed for run in self.runs})


def named(groups: Mapping[str, Sequence[RunRecord]]) -> list[Group]:
    """Return groups of runs by name, each in the order of seeds."""
    return [Group(name, _ordered(runs)) for name, runs in groups.items()]


def by_spec(runs: Sequence[RunRecord]) -> list[Group]:
    """Return a group for each spec, named by the fields in which it differs from the others."""
    found: dict[tuple, list[RunRecord]] = {}
    for run in runs:
        found.setdefault(_key(run, IGNORED), []).append(run)
    paths = differing([same[0].fields for same in found.values()])
    names = [_name(same[0], paths) for same in found.values()]
    if len(set(names)) < len(names):  # Labels are cut after some fields.
        names = [f"{name} ({number})" for number, name in enumerate(names, 1)]
    return named(dict(zip(names, found.values(), strict=True)))


def differences(groups: Sequence[Group]) -> dict[str, list[Any]]:
    """Return the fields in which groups differ, each with the value of every group."""
    flats = [group.runs[0].fields for group in groups]
    return {path: [flat.get(path) for flat in flats] for path in differing(flats)}


def refuse_wrong(groups: Sequence[Group], tasks: Sequence[str] = ()) -> None:
    """Raise `ValueError` for groups that cannot be compared; `tasks` are fields that may differ
    within a group."""
    if len({group.name for group in groups}) < len(groups):
        names = ", ".join(group.name for group in groups)
        raise ValueError(f"groups need names that differ, got {names}")
    for group in groups:
        _refuse_unfinished(group)
        _refuse_mixed(group, tasks)
        _refuse_seed_twice(group, tasks)
    _refuse_shared(groups)


def _refuse_unfinished(group: Group) -> None:
    if not group.runs:
        raise ValueError(f"group {group.name!r} needs a run, got none")
    for run in group.runs:
        if not run.finished:
            raise ValueError(
                f"group {group.name!r} needs finished runs, got {run.name}, which is "
                f"{run.state}"
            )


def _refuse_mixed(group: Group, tasks: Sequence[str]) -> None:
    allowed, first = (*IGNORED, *tasks), group.runs[0]
    for run in group.runs[1:]:
        if _key(run, allowed) == _key(first, allowed):
            continue
        paths = [path for path in differing([first.fields, run.fields]) if path not in allowed]
        path = paths[0]
        values = f"{first.fields.get(path)!r} in {first.name} and {run.fields.get(path)!r}"
        raise ValueError(
            f"group {group.name!r} needs runs that differ in the seed alone, got `{path}` "
            f"{values} in {run.name}"
        )


def _refuse_seed_twice(group: Group, tasks: Sequence[str]) -> None:
    seen: dict[Any, RunRecord] = {}
    for run in group.runs:
        key = (run.seed, *(repr(run.fields.get(path)) for path in tasks))
        if earlier := seen.get(key):
            raise ValueError(
                f"group {group.name!r} needs each seed once, got seed {run.seed} in "
                f"{earlier.name} and in {run.name}"
            )
        seen[key] = run


def _refuse_shared(groups: Sequence[Group]) -> None:
    seen: dict[str, tuple[str, RunRecord]] = {}
    for group in groups:
        for run in group.runs:
            name, earlier = seen.setdefault(run.identity, (group.name, run))
            if name != group.name:
                same = "" if earlier.name == run.name else f" (the same as {run.name})"
                raise ValueError(
                    f"a run belongs to one group, got {earlier.name}{same} in {name!r} and in "
                    f"{group.name!r}"
                )


def _name(run: RunRecord, paths: Sequence[str]) -> str:
    """Return the values of the fields, each with the last word of its path if that is clear."""
    last = [path.rpartition(".")[2].replace("_", " ") for path in paths]
    if not paths or len(set(last)) < len(last) or len(last) > MAX_FIELDS:
        return label(run.fields, paths) or "all runs"
    values = [value_text(run.fields.get(path)) for path in paths]
    return ", ".join(map(" ".join, zip(last, values, strict=True)))


def _key(run: RunRecord, ignored: Iterable[str]) -> tuple:
    return tuple(sorted((k, repr(v)) for k, v in run.fields.items() if k not in ignored))


def _ordered(runs: Sequence[RunRecord]) -> tuple[RunRecord, ...]:
    return tuple(sorted(runs, key=lambda run: run.seed))
