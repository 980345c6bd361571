"""Fork a run: choose initial creatures from it, and patch its spec."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError
from sqlalchemy.orm import Session

from microcosmos.spec import EXPERIMENTS, Evolution, Spec
from microcosmos.spec.search import MAX_INITIAL

from ..archives import elites, measures
from ..core.errors import ProblemError, invalid_field
from ..runs.schemas import Fork, ForkStart
from ..specs.parsing import Parse
from ..tables import Run

SEARCHES = tuple(name for name, one in EXPERIMENTS.items() if issubclass(one.spec, Evolution))
"""Experiments that can start from creatures."""


def spec_of(session: Session, run: Run, sent: Fork, parse: Parse) -> Spec:
    """Return the spec of the fork; raise `ValidationError` or `ProblemError`."""
    document = patched(run.spec, sent.spec)
    search = document.get("search")
    if document.get("experiment") not in SEARCHES or not isinstance(search, dict):
        needed = f"one of {', '.join(SEARCHES)}"
        raise invalid_field("experiment", needed, document.get("experiment"))
    names = chosen(session, run, sent.start, sent.generation)
    document = {**document, "search": {**search, "initial": names}}
    return parse(with_nulls(document, run.spec, sent.spec, parse))


def patched(document: Any, patch: Any) -> Any:
    """Apply a merge patch (RFC 7396): null removes a member."""
    if not isinstance(patch, Mapping):
        return patch
    whole = dict(document) if isinstance(document, Mapping) else {}
    for name, value in patch.items():
        if value is None:
            whole.pop(name, None)
        else:
            whole[name] = patched(whole.get(name), value)
    return whole


def with_nulls(document: Any, before: Any, patch: Any, parse: Parse) -> Any:
    """Set fields that a patch removed to null, where the spec allows null.

    Otherwise a default would replace the removed value; a merge patch cannot say null.
    """
    for path in _removed(before, patch):
        other = patched(document, {})
        parent = other
        for name in path[:-1]:
            parent[name] = dict(parent[name])
            parent = parent[name]
        parent[path[-1]] = None
        try:
            parse(other)
        except (ValidationError, ProblemError):
            continue
        document = other
    return document


def _removed(before: Any, patch: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    if not isinstance(before, Mapping) or not isinstance(patch, Mapping):
        return
    for name in before.keys() & patch.keys():
        if patch[name] is None and before[name] is not None:
            yield (*path, name)
        yield from _removed(before[name], patch[name], (*path, name))


def chosen(session: Session, run: Run, start: ForkStart, generation: int | None) -> list[str]:
    """Return the names of the initial creatures, each once."""
    if start.creatures is not None:
        return sorted(set(start.creatures))
    if not measures.has_archive(run):
        needed = "`creatures`, since this run has no archive"
        raise invalid_field("from", needed, run.experiment)
    as_of = run.generation if generation is None else min(generation, run.generation)
    archive = session.execute(elites.as_of(run, as_of)).all()
    within = _selection(run, start)
    names = sorted({elite.creature for elite in archive if within(elite)})
    filled = {elite.cell for elite in archive}
    if start.cells is not None and (empty := sorted(set(start.cells) - filled)):
        raise invalid_field("from.cells", "cells with an elite", empty[:10])
    if not names:
        field = "from.region" if start.region is not None else "from"
        raise invalid_field(field, "at least one elite", "none")
    if len(names) > MAX_INITIAL:
        needed = f"at most {MAX_INITIAL:,} creatures; choose a `region` or some `cells`"
        raise invalid_field("from", needed, len(names))
    return names


def _selection(run: Run, start: ForkStart) -> Callable[[Any], bool]:
    if start.cells is not None:
        cells = set(start.cells)
        return lambda elite: elite.cell in cells
    if start.region is None:
        return lambda _: True
    axes = [axis.name for axis in measures.axes(run)]
    if unknown := set(start.region) - set(axes):
        name = min(unknown)
        needed = f"one of the archive's axes {', '.join(axes)}"
        raise invalid_field(f"from.region.{name}", needed, name)
    ends = [(axes.index(name), *ends) for name, ends in start.region.items()]
    return lambda elite: all(low <= elite.descriptors[i] <= high for i, low, high in ends)
