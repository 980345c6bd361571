"""Wire types of choices."""

from typing import Annotated

from pydantic import Field

from ..core.schemas import Wire
from ..runs.schemas import Digest
from .choosing import MAX_PENDING


class Chosen(Wire):
    """Creatures to choose, by name."""

    creatures: Annotated[list[Digest], Field(min_length=1, max_length=MAX_PENDING)]


class ChoiceRead(Wire):
    creature: str
    generation: int | None
    """The first generation that descends from it; None until that begins."""


class ChoicesRead(Wire):
    """The chosen creatures of a run."""

    items: list[ChoiceRead]
    """By generation and name; those that do not count yet come last."""
    refusal: str | None
    """Why the run cannot descend from chosen creatures; None if it can."""
