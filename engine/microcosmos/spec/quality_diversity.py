"""The spec of a quality-diversity run, and its presets."""

from typing import Any, Literal, Self

from pydantic import model_validator

from .base import refuse
from .body import GrownBody
from .control import Genome
from .emitters import Emitter, NeatEmitter
from .encodings import BodyGraph
from .evolution import LITERAL, SMALL, Evolution
from .search import Archive, Descriptor, Screening, Search, refuse_flat_axes
from .world import Steric, World


class QualityDiversity(Evolution[Literal["quality-diversity"], Search]):
    """MAP-Elites over CPPN-controlled swimmers."""

    experiment: Literal["quality-diversity"] = "quality-diversity"
    search: Search = Search()

    @model_validator(mode="after")
    def check_search(self) -> Self:
        for emitter in self.search.emitters:
            if emitter.emits.gradients:
                refuse_flat_axes(self.archive, emitter.operator)
        if self.search.screening is None:
            return self
        control = self.control
        refuse(
            control.timer != "sine-cosine",
            "control.timer",
            "must be 'sine-cosine' with `search.screening`, which predicts "
            f"from one stroke, got {control.timer!r}",
        )
        # Rest shapes that depend on the flow do not repeat each stroke, and screening sees one.
        for name in ("sense_energy", "recurrent"):
            refuse(
                getattr(control, name, False),
                f"control.{name}",
                "must be false with `search.screening`, which predicts "
                "from one stroke, got true",
            )
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

FORM_AND_MOTION = (
    Descriptor(name="free_ends", low=-0.5, high=7.5, bins=8),
    Descriptor(name="form_aspect", bins=8),
    Descriptor(name="curvature_mean", bins=8),
)
ZOO: dict[str, Any] = {
    "world": World(steric=Steric(smoothing="binomial")),
    "body": GrownBody(builder="grown"),
    "control": BodyGraph(),
    "genome": Genome(max_nodes=32, max_connections=96),
    "archive": Archive(descriptors=FORM_AND_MOTION),
}
"""Parts of the searches for bodies."""

FEW = Screening(rounds=2, candidates=20)
"""Screening where the description of a candidate takes longer, since its body grows."""

PRESETS = {
    "demo": (
        "A small demonstration, a minute on two cores; the fittest swim 0.6 lengths in "
        "1,000 steps",
        DEMO,
    ),
    "standard": (
        "24 nodes in 48 × 48 cells: 3,200 swimmers, chosen from half a million that are "
        "predicted, two minutes on two cores; the fittest swim 0.65 lengths in 1,000 steps",
        QualityDiversity(search=Search(screening=Screening())),
    ),
    "zoo": (
        "Bodies that evolve: 25,600 swimmers that grow from plans of segments, chosen from a "
        "million that are predicted, a quarter of an hour on two cores; the fittest swim 0.75 "
        "lengths in 1,000 steps",
        QualityDiversity(**ZOO, search=Search(generations=400, screening=FEW)),
    ),
    "zoo-demo": (
        "Bodies that evolve, a small demonstration: 5,120 swimmers, three minutes on two cores",
        QualityDiversity(**ZOO, search=Search(generations=80, screening=FEW)),
    ),
    "paper": (
        "As in the paper: linear timer and efforts, two layers, repulsion; not force-free, and "
        "infeasible creatures are elites",
        PAPER,
    ),
}
