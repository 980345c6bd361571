"""Decorators that declare the plug-ins of a module."""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

from pydantic import BaseModel

from .declaration import NAME, Axis, Kind

MARK = "__microcosmos__"
"""The attribute that marks a declared function."""

F = TypeVar("F", bound=Callable[..., Any])
Settings = type[BaseModel] | None


@dataclass(frozen=True)
class Draft:
    """A declaration before the name of its module is known."""

    kind: Kind
    name: str
    title: str
    unit: str = ""
    axis: Axis | None = None
    sizes: dict[str, int] = field(default_factory=dict)
    settings: Settings = None


def fitness(name: str, *, title: str, unit: str = "", settings: Settings = None):
    """Declare a fitness: a JAX function from a `search.Motion` to one number."""
    return _declared(Draft("fitness", name, title, unit, settings=settings))


def descriptor(
    name: str,
    *,
    title: str,
    low: float,
    high: float,
    scale: Literal["linear", "log10"] = "linear",
    unit: str = "",
    settings: Settings = None,
):
    """Declare a descriptor: a JAX function from a `search.Motion` to one number."""
    axis = Axis(low=low, high=high, scale=scale)
    return _declared(Draft("descriptor", name, title, unit, axis, settings=settings))


def body(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declare a body: a NumPy function that returns a `bodies.Body` of at most `nodes`."""
    return _declared(Draft("body", name, title, sizes={"nodes": nodes}, settings=settings))


def gait(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declare a gait: a NumPy function that returns a `swimmers.Swimmer`."""
    return _declared(Draft("gait", name, title, sizes={"nodes": nodes}, settings=settings))


def encoding(
    name: str,
    *,
    title: str,
    genes: int = 0,
    per_joint: int = 0,
    per_edge: int = 0,
    settings: Settings = None,
):
    """Declare an encoding: a JAX function from genes and a `genomes.Clock` to movements.

    A body has `genes` genes, and more per joint and per edge, all from −1 to 1. The function
    returns the control of joints (time, joint) and of edges (time, edge), from −1 to 1.
    """
    if genes + per_joint + per_edge < 1:
        raise ValueError(f"`genes` of {name!r} must be at least 1, or those per joint or edge")
    sizes = {"genes": genes, "per_joint": per_joint, "per_edge": per_edge}
    return _declared(Draft("encoding", name, title, sizes=sizes, settings=settings))


def _declared(draft: Draft) -> Callable[[F], F]:
    if not re.fullmatch(NAME, draft.name):
        raise ValueError(f"`name` must be of a-z, 0-9 and _, got {draft.name!r}")
    _refuse_unfit(draft)

    def mark(function: F) -> F:
        _refuse_arguments(draft, function)
        setattr(function, MARK, draft)
        return function

    return mark


def _refuse_unfit(draft: Draft) -> None:
    """Raise `ValueError` unless settings refuse unknown fields and have all defaults."""
    model = draft.settings
    if model is None:
        return
    if not issubclass(model, BaseModel) or model.model_config.get("extra") != "forbid":
        raise ValueError(f"`settings` of {draft.name!r} must be a `microcosmos.spec.Part`")
    needed = [name for name, one in model.model_fields.items() if one.is_required()]
    if needed:
        raise ValueError(
            f"`settings` of {draft.name!r} must all have defaults, got none for "
            f"{', '.join(needed)}"
        )


ARGUMENTS = {"fitness": 1, "descriptor": 1, "body": 0, "gait": 0, "encoding": 2}
"""Number of arguments of each kind of function, without settings."""


def _refuse_arguments(draft: Draft, function: Callable[..., Any]) -> None:
    needed = ARGUMENTS[draft.kind] + (draft.settings is not None)
    try:
        inspect.signature(function).bind(*range(needed))
    except TypeError as error:
        settings = ", its settings the last" if draft.settings else ""
        raise ValueError(
            f"{draft.kind} {draft.name!r} must take {needed} arguments{settings}: {error}"
        ) from error
