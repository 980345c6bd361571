"""The spec of the refinement of one creature, and its presets."""

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import field_validator, model_validator

from ..invalid import InvalidField
from .base import OURS, Part, field, refuse
from .coupling import refuse_without_feasible
from .creature import CreatureError, alone, scene_of
from .creature import check as checked
from .search import Archive, refuse_flat_axes


class Refinement(Part):
    """One creature made fitter by gradients, within its cell."""

    experiment: Literal["refinement"] = "refinement"
    creature: dict[str, Any]
    """Creature file."""
    archive: Archive = Archive()
    """Archive whose cell the creature stays in."""
    steps: int = field(20, ge=1, le=10_000)
    """Number of steps; each takes one gradient and a block of trials along it."""
    length: float = field(0.2, gt=0.0, le=100.0)
    """Length of the first step in the space of weights and biases, or of genes. It doubles if
    the longest trial is best and shrinks if no trial is better."""
    block: int = field(8, ge=2, le=256, unit="trials")
    """Trials per step, evaluated together; the exact bits of results depend on it."""
    feasible: bool = field(True, source=OURS)
    """Refuse trials that a search with `search.feasible` would refuse."""
    segment: int | None = field(None, ge=1, unit="steps")
    """Steps that a gradient keeps in memory at a time, recomputing the others; empty: all."""

    @field_validator("creature")
    @classmethod
    def leave_ancestors_out(cls, creature: dict[str, Any]) -> dict[str, Any]:
        return alone(creature)

    @model_validator(mode="after")
    def check(self) -> Self:
        file = parsed(self.creature)
        encoding = file["identity"]["genome"]["encoding"]
        refuse(
            encoding in ("gait", "fold"),
            "creature",
            f"must have genes to refine, got a {encoding}",
        )
        refuse_flat_axes(self.archive, "refinement")
        if self.archive.container is not None:
            kind = self.archive.container.kind
            raise InvalidField(
                "archive.container", f"must be empty for a refinement, got {kind!r}"
            )
        if self.feasible:
            refuse_without_feasible(scene_of(file).coupling, "feasible")
        return self

    @property
    def generations(self) -> int:
        """Return the number of steps, and one for the unchanged creature."""
        return 1 + self.steps


def parsed(creature: Mapping[str, Any]) -> dict[str, Any]:
    """Return the checked creature file; raise `ValueError` with the field."""
    try:
        return checked(creature)
    except CreatureError as error:
        raise error.within("creature") from error


PRESETS: dict[str, tuple[str, Refinement]] = {}
