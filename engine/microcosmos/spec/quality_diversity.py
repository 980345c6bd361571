"""The spec of a quality-diversity run, and its presets."""

from typing import Literal, Self

from pydantic import model_validator

from .emitters import USING_GRADIENTS, Emitter, NeatEmitter
from .evolution import LITERAL, SMALL, Evolution
from .search import Archive, Descriptor, Search, refuse_flat_axes


class QualityDiversity(Evolution[Literal["quality-diversity"], Search]):
    """MAP-Elites over CPPN-controlled swimmers."""

    experiment: Literal["quality-diversity"] = "quality-diversity"
    search: Search = Search()

    @model_validator(mode="after")
    def check_descriptors(self) -> Self:
        for emitter in self.search.emitters:
            if emitter.operator in USING_GRADIENTS:
                refuse_flat_axes(self.archive, emitter.operator)
        return self

    @property
    def emitters(self) -> tuple[Emitter, ...]:
        return self.search.emitters

    @property
    def slots(self) -> tuple[int, ...]:
        return self.search.slots


AXES = ("symmetry", "curvature_mean")

DEMO = QualityDiversity(
    **SMALL,
    archive=Archive(descriptors=tuple(Descriptor(name=name, bins=16) for name in AXES)),
    search=Search(generations=300, batch=16),
)

PAPER = QualityDiversity(
    **LITERAL,
    search=Search(feasible=False, emitters=(NeatEmitter(select="uniform"),)),
    archive=Archive(
        descriptors=(
            Descriptor(name="bending_effort", low=0, high=0.5, scale="linear"),
            Descriptor(name="stretching_effort", low=0, high=0.15, scale="linear"),
        )
    ),
)

PRESETS = {
    "demo": (
        "A small demonstration, a minute on two cores; the fittest swim 0.6 lengths in "
        "1,000 steps",
        DEMO,
    ),
    "standard": (
        "24 nodes in 48 × 48 cells: 3,200 swimmers, a minute on two cores; the fittest "
        "swim 0.6 lengths in 1,000 steps",
        QualityDiversity(),
    ),
    "paper": (
        "As in the paper: linear timer and efforts, two layers, repulsion; not force-free, and "
        "infeasible creatures are elites",
        PAPER,
    ),
}
