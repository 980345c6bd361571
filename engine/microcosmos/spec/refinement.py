"""The spec of the refinement of one creature, and its presets."""

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from .base import Part, unit
from .creature import CreatureError
from .creature import check as checked
from .search import Archive, refuse_flat_axes


class Refinement(Part):
    """One creature made fitter by gradients, within its cell."""

    experiment: Literal["refinement"] = "refinement"
    creature: dict[str, Any]
    """The creature file, as an archive or anybody shares it."""
    archive: Archive = Archive()
    """Whose cells it is not to leave."""
    steps: int = Field(default=20, ge=1, le=10_000)
    """Steps; each takes a gradient and a block of trials along it."""
    length: float = Field(default=0.2, gt=0.0, le=100.0)
    """Length of the first step, in the space of weights and biases or of genes; it doubles
    where the longest trial is the best, and becomes shorter where none is better."""
    block: int = Field(default=8, ge=2, le=256, json_schema_extra=unit("trials"))
    """Trials of a step, evaluated together; results depend on their bits."""
    segment: int | None = Field(default=None, ge=1, json_schema_extra=unit("steps"))
    """Steps of the simulation that the gradient keeps in memory at a time, the others done
    twice; empty: all."""

    @model_validator(mode="after")
    def check(self) -> Self:
        file = parsed(self.creature)
        encoding = file["identity"]["genome"]["encoding"]
        if encoding in ("gait", "fold"):
            raise ValueError(f"`creature` must have genes that are searched, got a {encoding}")
        refuse_flat_axes(self.archive, "refinement")
        return self

    @property
    def generations(self) -> int:
        """The creature as it is, then every step."""
        return 1 + self.steps


def parsed(creature: Mapping[str, Any]) -> dict[str, Any]:
    """The creature file, checked; raises `ValueError` with the field."""
    try:
        return checked(creature)
    except CreatureError as error:
        raise ValueError(f"`creature.{error.field}` {error.needed}; got another") from error


PRESETS: dict[str, tuple[str, Refinement]] = {}
