"""Declarations of plug-ins, and the decorators that make them."""

import inspect
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, Self, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..invalid import InvalidField
from ..measures import Scale, refuse_empty_axis

Kind = Literal["fitness", "descriptor", "body", "gait", "encoding", "emitter"]
KINDS: Final = get_args(Kind)

NAME = r"[a-z][a-z0-9_]{0,62}"
"""Pattern of a module's name, and of a plug-in's name in it."""
FULL_NAME = re.compile(rf"{NAME}\.{NAME}")

Size = Annotated[int, Field(ge=0, le=65_536)]


def is_plugin(name: object) -> bool:
    """Return whether a name is that of a plug-in: it contains a dot, built-in names do not."""
    return isinstance(name, str) and FULL_NAME.fullmatch(name) is not None


class Axis(BaseModel):
    """Default ends and scale of an archive's axis."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    low: float
    high: float
    scale: Scale = "linear"

    @model_validator(mode="after")
    def refuse_empty(self) -> Self:
        refuse_empty_axis(self.low, self.high, self.scale)
        return self


Genes = Literal["networks", "numbers"]
"""Kinds of genomes that an emitter may vary."""
Learns = Literal["nothing", "offspring", "cells"]
"""Source from which an emitter learns: nothing (any number of its offspring may be evaluated),
all of its offspring, or also the cells that they enter."""


class Emits(BaseModel):
    """Facts about an emitter: genomes that it varies, source of learning, gradients."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    varies: Annotated[tuple[Genes, ...], Field(min_length=1)]
    learns: Learns = "nothing"
    gradients: Annotated[int, Field(ge=0, le=65_536)] = 0
    """Gradients of fitness and all descriptors that it needs in a generation."""


class Declaration(BaseModel):
    """The name, kind and version of a plug-in."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Kind
    name: Annotated[str, Field(pattern=rf"^{FULL_NAME.pattern}$")]
    """Name of the module, a dot, and the plug-in's name."""
    source: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the module's source."""
    title: Annotated[str, Field(min_length=1, max_length=100)]
    unit: Annotated[str, Field(max_length=40)] = ""
    about: Annotated[str, Field(max_length=1000)] = ""
    """Description in one sentence."""
    axis: Axis | None = None
    """Axis of a descriptor."""
    sizes: dict[str, Size] = {}
    """Most `nodes` of a body; `genes`, `per_joint` and `per_edge` of an encoding."""
    emits: Emits | None = None
    """Facts about an emitter."""
    settings: dict[str, Any] | None = None
    """JSON schema of the settings, if there are any."""
    defaults: dict[str, Any] = {}
    """Default settings."""


MARK = "__microcosmos__"
"""The attribute that marks a declared function."""

F = TypeVar("F", bound=Callable[..., Any])
Settings = type[BaseModel] | None


@dataclass(frozen=True)
class Draft:
    """A declaration before the module is known: fields of `Declaration`, and the settings."""

    fields: dict[str, Any]
    settings: Settings


def fitness(name: str, *, title: str, unit: str = "", settings: Settings = None):
    """Declare a fitness: a JAX function from a `search.Motion` to one number."""
    return _declared("fitness", name, settings, title=title, unit=unit)


def descriptor(
    name: str,
    *,
    title: str,
    low: float,
    high: float,
    scale: Scale = "linear",
    unit: str = "",
    settings: Settings = None,
):
    """Declare a descriptor: a JAX function from a `search.Motion` to one number."""
    refuse_empty_axis(low, high, scale)
    axis = Axis(low=low, high=high, scale=scale)
    return _declared("descriptor", name, settings, title=title, unit=unit, axis=axis)


def body(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declare a body: a NumPy function that returns a `bodies.Body` of at most `nodes`."""
    return _declared("body", name, settings, title=title, sizes={"nodes": nodes})


def gait(name: str, *, title: str, nodes: int, settings: Settings = None):
    """Declare a gait: a NumPy function that returns a `swimmers.Swimmer`."""
    return _declared("gait", name, settings, title=title, sizes={"nodes": nodes})


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
        raise InvalidField(
            "genes", f"of {name!r} must be at least 1, or those per joint or edge"
        )
    sizes = {"genes": genes, "per_joint": per_joint, "per_edge": per_edge}
    return _declared("encoding", name, settings, title=title, sizes=sizes)


def emitter(
    name: str,
    *,
    title: str,
    varies: Iterable[Genes] = ("numbers",),
    learns: Learns = "nothing",
    gradients: int = 0,
    settings: Settings = None,
):
    """Declare an emitter: a function from a `search.emitters.Problem` to a `search.Emitter`.

    One that learns nothing is a dataclass with `slots` and has no state. One that needs
    `gradients` is a `search.emitters.Learner`.
    """
    emits = Emits(varies=tuple(varies), learns=learns, gradients=gradients)
    return _declared("emitter", name, settings, title=title, emits=emits)


def _declared(kind: Kind, name: str, settings: Settings, **fields: Any) -> Callable[[F], F]:
    if not re.fullmatch(NAME, name):
        raise InvalidField("name", f"must be of a-z, 0-9 and _, got {name!r}")
    # A form is made of the defaults, and a misspelt setting must not be ignored.
    if settings is not None:
        _refuse_unfit(name, settings)

    def mark(function: F) -> F:
        _refuse_arguments(kind, name, settings is not None, function)
        setattr(function, MARK, Draft({"kind": kind, "name": name, **fields}, settings))
        return function

    return mark


def _refuse_unfit(name: str, settings: type[BaseModel]) -> None:
    """Raise `ValueError` unless settings refuse unknown fields and have all defaults."""
    if not issubclass(settings, BaseModel) or settings.model_config.get("extra") != "forbid":
        raise InvalidField("settings", f"of {name!r} must be a `microcosmos.spec.Part`")
    needed = [field for field, one in settings.model_fields.items() if one.is_required()]
    if needed:
        raise InvalidField(
            "settings", f"of {name!r} must all have defaults, got none for {', '.join(needed)}"
        )


ARGUMENTS = {
    "fitness": 1,
    "descriptor": 1,
    "body": 0,
    "gait": 0,
    "encoding": 2,
    "emitter": 1,
}
"""Number of arguments of each kind of function, without settings."""


def _refuse_arguments(
    kind: Kind, name: str, has_settings: bool, function: Callable[..., Any]
) -> None:
    needed = ARGUMENTS[kind] + has_settings
    try:
        inspect.signature(function).bind(*range(needed))
    except TypeError as error:
        settings = ", its settings the last" if has_settings else ""
        raise ValueError(
            f"{kind} {name!r} must take {needed} arguments{settings}: {error}"
        ) from error
