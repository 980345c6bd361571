"""The decorators by which a module says what it adds."""

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

from pydantic import BaseModel

from .declaration import NAME, Axis, Kind

MARK = "__microcosmos__"
"""The attribute by which a declared function is known."""

F = TypeVar("F", bound=Callable[..., Any])
Settings = type[BaseModel] | None


@dataclass(frozen=True)
class Draft:
    """What a decorator says of a function, before it is known which module it is in."""

    kind: Kind
    name: str
    title: str
    unit: str = ""
    axis: Axis | None = None
    sizes: dict[str, int] = field(default_factory=dict)
    settings: Settings = None


def fitness(name: str, *, title: str, unit: str = "", settings: Settings = None):
    """Declares what is to be large: from a `search.Motion` to one number, in JAX."""
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
    """Declares an axis of archives: from a `search.Motion` to one number, in JAX."""
    axis = Axis(low=low, high=high, scale=scale)
    return _declared(Draft("descriptor", name, title, unit, axis, settings=settings))


def body(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declares what gives a `bodies.Body` of at most so many nodes, in NumPy."""
    return _declared(Draft("body", name, title, sizes={"nodes": nodes}, settings=settings))


def gait(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declares what gives a `swimmers.Swimmer`, a body with its gait, in NumPy."""
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
    """Declares what genes from −1 to 1 do to the rest shape over time, in JAX.

    There are so many genes for a body as a whole, for each of its joints and of its edges.
    The function is given them and a `genomes.Clock`, and gives what every joint (time,
    joint) and every edge (time, edge) does, from −1 to 1.
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
    """Settings must refuse what they do not know, and be complete where nothing is said."""
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


GIVEN = {"fitness": 1, "descriptor": 1, "body": 0, "gait": 0, "encoding": 2}
"""Arguments of each kind of function, settings not among them."""


def _refuse_arguments(draft: Draft, function: Callable[..., Any]) -> None:
    needed = GIVEN[draft.kind] + (draft.settings is not None)
    try:
        inspect.signature(function).bind(*range(needed))
    except TypeError as error:
        settings = ", its settings the last" if draft.settings else ""
        raise ValueError(
            f"{draft.kind} {draft.name!r} must take {needed} arguments{settings}: {error}"
        ) from error
