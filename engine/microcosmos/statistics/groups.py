"""Groups of runs: checks for wrong use, and the fields in which their specs differ."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..spec.paths import (
    IGNORED,
    MAX_FIELDS,
    differing,
    is_none,
    key,
    label,
    value_text,
    value_texts,
)
from .records import RunRecord


@dataclass(frozen=True, eq=False)
class Group:
    """Runs that differ in their seed alone, or also in the fields of tasks."""

    name: str
    runs: tuple[Any, ...]
    """Records, or archives of figures: both have the fields and the seed of a spec."""

    @property
    def seeds(self) -> list[int]:
        return sorted({run.seed for run in self.runs})


def named(groups: Mapping[str, Sequence[RunRecord]]) -> list[Group]:
    """Return groups of runs by name, each in the order of seeds."""
    return [Group(name, in_order(runs)) for name, runs in groups.items()]


def by_spec(runs: Sequence[RunRecord]) -> list[Group]:
    """Return a group for each spec, named by the fields in which it differs from the others."""
    alike: dict[tuple, list[RunRecord]] = {}
    for run in runs:
        alike.setdefault(spec_key(run.fields, IGNORED), []).append(run)
    paths = differing([same[0].fields for same in alike.values()])
    names = distinct([_name(same[0], paths) for same in alike.values()])
    return named(dict(zip(names, alike.values(), strict=True)))


def versions(groups: Sequence[Group]) -> tuple[str, ...]:
    """Return the versions of all runs, each once."""
    return tuple(dict.fromkeys(run.version for group in groups for run in group.runs))


def devices(groups: Sequence[Group]) -> tuple[str, ...]:
    """Return the kinds of device of all runs, each once."""
    runs = [run for group in groups for run in group.runs]
    return tuple(dict.fromkeys(device for run in runs for device in run.devices))


def distinct(names: Sequence[str]) -> list[str]:
    """Return the names, numbered if two are equal: labels are cut after some fields."""
    if len(set(names)) == len(names):
        return list(names)
    return [f"{name} ({number})" for number, name in enumerate(names, 1)]


def differences(groups: Sequence[Group], tasks: Sequence[str] = ()) -> dict[str, list[Any]]:
    """Return the fields in which groups differ, each with the value of every group.

    The fields of `tasks`, which differ within a group, are left out.
    """
    flats = [group.runs[0].fields for group in groups]
    paths = [path for path in differing(flats) if path not in tasks]
    return {path: [flat.get(path) for flat in flats] for path in paths}


def refuse_wrong(groups: Sequence[Group], tasks: Sequence[str] = ()) -> None:
    """Raise `ValueError` for groups that cannot be compared.

    `tasks` are fields that may differ within a group.
    """
    for group in groups:
        _refuse_unfinished(group)
    refuse_mixed(groups, tasks)


def refuse_mixed(groups: Sequence[Group], tasks: Sequence[str] = ()) -> None:
    """Raise `ValueError` for groups that are empty, mix specs, or have a run or a seed twice.

    `tasks` are fields that may differ within a group.
    """
    if not groups:
        raise ValueError("statistics need a group, got none")
    if len({group.name for group in groups}) < len(groups):
        names = ", ".join(group.name for group in groups)
        raise ValueError(f"groups need names that differ, got {names}")
    for group in groups:
        if not group.runs:
            raise ValueError(f"group {group.name!r} needs a run, got none")
        _refuse_several_specs(group, tasks)
        _refuse_seed_twice(group, tasks)
    _refuse_shared(groups)


def _refuse_unfinished(group: Group) -> None:
    for run in group.runs:
        if not run.finished:
            raise ValueError(
                f"group {group.name!r} needs finished runs, got {run.name}, which is "
                f"{run.state}"
            )


def _refuse_several_specs(group: Group, tasks: Sequence[str]) -> None:
    # All runs at once: fields that follow from a task may still differ within the task.
    paths = differing([run.fields for run in group.runs])
    path = next((path for path in paths if path not in tasks), None)
    if path is None:
        return
    first, value = group.runs[0], group.runs[0].fields.get(path)
    other = next(run for run in group.runs if key(run.fields.get(path)) != key(value))
    ours, theirs = value_texts([value, other.fields.get(path)])
    raise ValueError(
        f"group {group.name!r} needs runs that differ in the seed alone, got `{path}` "
        f"{ours} in {first.name} and {theirs} in {other.name}"
    )


def _refuse_seed_twice(group: Group, tasks: Sequence[str]) -> None:
    seen: dict[Any, RunRecord] = {}
    for run in group.runs:
        # Runs of different tasks may have one seed.
        place = (run.seed, *(key(run.fields.get(path)) for path in tasks))
        if earlier := seen.get(place):
            raise ValueError(
                f"group {group.name!r} needs each seed once, got seed {run.seed} in "
                f"{earlier.name} and in {run.name}"
            )
        seen[place] = run


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
    unclear = len(set(last)) < len(last) or "kind" in last
    if not paths or unclear or len(last) > MAX_FIELDS:
        return label(run.fields, paths) or "all runs"
    values = [value_text(run.fields.get(path)) for path in paths]
    return ", ".join(map(" ".join, zip(last, values, strict=True)))


def spec_key(fields: Mapping[str, Any], ignored: Iterable[str]) -> tuple:
    """Return a key that is equal for specs that differ only in ignored fields."""
    stated = ((k, v) for k, v in fields.items() if k not in ignored and not is_none(v))
    return tuple(sorted((k, repr(v)) for k, v in stated))


def in_order(runs: Sequence[Any]) -> tuple[Any, ...]:
    """Return runs in the order of their seeds."""
    return tuple(sorted(runs, key=lambda run: run.seed))
