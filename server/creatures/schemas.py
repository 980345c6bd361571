"""Wire types of creatures and their relatives."""

from pydantic import Field

from ..core.schemas import Wire


class Relative(Wire):
    """An ancestor or a child of a creature."""

    creature: str
    distance: int
    """Generations between the two."""
    stored: bool
    """False if it never was an elite; then only its name is known."""
    parents: list[str]
    operator: str | None
    generation: int | None
    fitness: float | None
    licence: str | None = None
    credit: list[str] = Field(default=[])
    """People whom its file asks to name; its descendants' files name them too."""


class Ancestors(Wire):
    parents: list[str]
    """Parents of the creature itself."""
    items: list[Relative]
    """Nearest first."""
    more: bool
    """There are others, older than requested or too many for one answer."""


class Children(Wire):
    total: int
    items: list[Relative]
    """Best first; those that were never measured come last."""


class CreatureName(Wire):
    creature: str
