"""A new run that begins from creatures of another: which ones, and what is to be different."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError
from sqlalchemy.orm import Session

from microcosmos.spec import EXPERIMENTS, Evolution, Spec
from microcosmos.spec.search import MAX_INITIAL

from ..archives import elites, measures
from ..core.errors import FieldError, ProblemError, brief
from ..runs.schemas import Beginning, Fork
from ..specs.parsing import Parse
from ..tables import Run

SEARCHES = tuple(name for name, one in EXPERIMENTS.items() if issubclass(one.spec, Evolution))
"""Experiments that can begin from creatures."""


def spec_of(session: Session, run: Run, sent: Fork, parse: Parse) -> Spec:
    """The spec of the new run; raises `ValidationError`, which names each field at fault."""
    document = patched(run.spec, sent.spec)
    search = document.get("search")
    if document.get("experiment") not in SEARCHES or not isinstance(search, dict):
        needed = f"one of {', '.join(SEARCHES)}"
        raise refused("experiment", needed, document.get("experiment"))
    names = chosen(session, run, sent.start, sent.generation)
    document = {**document, "search": {**search, "initial": names}}
    return parse(emptied(document, run.spec, sent.spec, parse))


def patched(document: Any, patch: Any) -> Any:
    """A document with a merge patch applied (RFC 7396): null takes a member away."""
    if not isinstance(patch, Mapping):
        return patch
    whole = dict(document) if isinstance(document, Mapping) else {}
    for name, value in patch.items():
        if value is None:
            whole.pop(name, None)
        else:
            whole[name] = patched(whole.get(name), value)
    return whole


def emptied(document: Any, before: Any, patch: Any, parse: Parse) -> Any:
    """The document with none where the patch took a value away and none can stand in its place.

    A merge patch has no other word for none, and a default would bring back what was taken.
    """
    for path in _taken(before, patch):
        other = patched(document, {})
        place = other
        for name in path[:-1]:
            place[name] = dict(place[name])
            place = place[name]
        place[path[-1]] = None
        try:
            parse(other)
        except (ValidationError, ProblemError):
            continue
        document = other
    return document


def _taken(before: Any, patch: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Where a patch takes away what a document has."""
    if not isinstance(before, Mapping) or not isinstance(patch, Mapping):
        return
    for name in before.keys() & patch.keys():
        if patch[name] is None and before[name] is not None:
            yield (*path, name)
        yield from _taken(before[name], patch[name], (*path, name))


def chosen(session: Session, run: Run, start: Beginning, generation: int | None) -> list[str]:
    """Names of the creatures that a fork begins from, each once."""
    if start.creatures is not None:
        return sorted(set(start.creatures))
    if not measures.searched(run):
        raise refused("from", "`creatures`, since this run fills no archive", run.experiment)
    as_of = run.generation if generation is None else min(generation, run.generation)
    living = session.execute(elites.at(run, as_of)).all()
    within = _place(run, start)
    names = sorted({elite.creature for elite in living if within(elite)})
    _refuse_empty(start, {elite.cell for elite in living}, names)
    if len(names) > MAX_INITIAL:
        needed = f"at most {MAX_INITIAL:,} creatures (a `region`, or some `cells`)"
        raise refused("from", needed, len(names))
    return names


def _place(run: Run, start: Beginning) -> Callable[[Any], bool]:
    """Whether an elite lives where a fork is to begin."""
    if start.cells is not None:
        cells = set(start.cells)
        return lambda elite: elite.cell in cells
    if start.region is None:
        return lambda _: True
    axes = [axis.name for axis in measures.axes(run)]
    if unknown := set(start.region) - set(axes):
        name = min(unknown)
        raise refused(
            f"from.region.{name}", f"one of the archive's axes {', '.join(axes)}", name
        )
    ends = [(axes.index(name), *ends) for name, ends in start.region.items()]
    return lambda elite: all(low <= elite.descriptors[i] <= high for i, low, high in ends)


def _refuse_empty(start: Beginning, occupied: set[int], names: list[str]) -> None:
    if start.cells is not None and (empty := sorted(set(start.cells) - occupied)):
        raise refused("from.cells", "cells in which somebody lives", empty[:10])
    if not names:
        place = "from.region" if start.region is not None else "from"
        raise refused(place, "somebody to begin from; nobody lives there", None)


def refused(field: str, needed: str, got: Any) -> ProblemError:
    message = f"needs {needed}; got {brief(got)!r}"
    error = FieldError(field=field, message=message, needed=needed, got=brief(got))
    return ProblemError(422, "Invalid input", f"{field}: {message}", [error])
