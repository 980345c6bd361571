"""Containers that replace one elite in each cell of an archive."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..measures import MeasureName
from .base import AURORA, DOMINATED_NOVELTY, MOME, Part, field, refuse, refuse_repeated, sourced
from .plugins import OR_PLUGIN


class Fronts(Part):
    """Pareto fronts: in each cell the elites that no other equals or exceeds in both fitness
    and a measure.

    Of a front that is too long the ends remain, and those farthest from their neighbours on it.
    """

    model_config = sourced(MOME)

    kind: Literal["fronts"] = "fronts"
    measure: MeasureName = "cost_of_transport"
    """Second objective, another than the fitness's; its default axis has the scale of
    distances and of the hypervolume."""
    goal: Literal["least", "most"] = "least"
    """The least or the most of the measure is best."""
    size: int = field(8, ge=2, le=64, unit="elites")
    """Longest front of a cell."""


class DominatedNovelty(Part):
    """Dominated novelty search: elites that are far from all that are fitter.

    The bins of the descriptors only serve the figures.
    """

    model_config = sourced(DOMINATED_NOVELTY)

    kind: Literal["dominated-novelty"] = "dominated-novelty"
    size: int = field(256, ge=2, le=4096, unit="elites")
    """Number of elites."""
    neighbours: int = field(3, ge=1, le=64, unit="elites")
    """Nearest fitter elites whose mean distance decides."""


# With all measures the first axis is the size of the motion, 38 % of the variance, so slow
# creatures get most of the cells (docs/evolution.md, "Learned axes").
STROKE: tuple[MeasureName, ...] = (
    "symmetry",
    "curvature_mean",
    "curvature_spread",
    "bending_effort",
    "stretching_effort",
    "beats",
    "wave_number",
    "wave_direction",
    "aspect",
    "turning",
)
"""Measures of a stroke, not of how far it carries."""


class LearnedAxes(Part):
    """Cells along axes that are learned: principal components of the elites' measures.

    The axes are learned in the first generation, in generation `first`, and whenever the number
    of generations has doubled; elites and offspring then compete for the new cells. The bins of
    the descriptors only serve the figures.
    """

    model_config = sourced(AURORA)

    kind: Literal["learned"] = "learned"
    axes: int = field(2, ge=1, le=4)
    """Number of axes."""
    bins: int = field(16, ge=2, le=256)
    """Bins along each axis."""
    first: int = field(10, ge=2, le=1_000_000, unit="generations")
    """Generation in which the axes are learned for the second time."""
    measures: tuple[Annotated[MeasureName, *OR_PLUGIN], ...] = STROKE
    """Measures of which the axes are made; empty: all that are recorded, most of which tell how
    far a creature gets."""

    @model_validator(mode="after")
    def refuse_too_few(self) -> "LearnedAxes":
        refuse_repeated("measures", self.measures)
        refuse(
            self.measures and len(self.measures) < self.axes,
            "measures",
            f"must be at least as many as `axes` ({self.axes}), got {len(self.measures)}",
        )
        return self


Container = Annotated[
    Fronts | DominatedNovelty | LearnedAxes,
    Field(discriminator="kind"),
]
"""A container that replaces one elite in each cell."""
