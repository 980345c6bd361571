"""Creatures, their kin, and what is made of them."""

from typing import Literal

from pydantic import Field

from ..core.schemas import Wire


class Relative(Wire):
    """Somebody in a creature's lineage."""

    creature: str
    distance: int
    """Generations between the two."""
    kept: bool
    """Whether it ever was an elite; of others nothing but the name is known."""
    parents: list[str]
    operator: str | None
    generation: int | None
    fitness: float | None
    licence: str | None = None
    credit: list[str] = Field(default=[])
    """Whom its file asks to name; what came of it is theirs too."""


class Ancestors(Wire):
    parents: list[str]
    """Of the creature itself."""
    items: list[Relative]
    """Nearest first."""
    more: bool
    """Whether there are others, older than was asked for or too many for one answer."""


class Children(Wire):
    total: int
    items: list[Relative]
    """Best first; those that were never measured come last."""


class CreatureName(Wire):
    creature: str


class Rendering(Wire):
    status: Literal["rendering"] = "rendering"


class Again(Wire):
    """A recorded figure and the same one measured here; None where it is not finite."""

    name: str
    recorded: float
    measured: float | None


class Measurement(Wire):
    """What came of evaluating a creature again by the program that measured it."""

    creature: str
    exact: bool
    """Whether every recorded figure is the same to the bit."""
    device: str
    recorded_device: str
    fitness: Again
    figures: list[Again]
    """Those that differ, the largest share first."""
