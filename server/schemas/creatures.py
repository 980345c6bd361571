"""Creatures, their kin, and what is made of them."""

from typing import Literal

from .base import Wire


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
