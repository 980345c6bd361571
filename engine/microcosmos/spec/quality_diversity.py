"""The spec of a quality-diversity run, its presets, and what it will need."""

from math import ceil
from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part
from .control import Control, Genome
from .search import Archive, Descriptor, Search, Task
from .world import SUPPORT, Body, Coupling, World


class QualityDiversity(Part):
    """MAP-Elites over CPPN-controlled swimmers."""

    experiment: Literal["quality-diversity"] = "quality-diversity"
    seed: int = Field(default=0, ge=0, lt=2**32)
    """The one source of randomness."""
    world: World = World()
    body: Body = Body()
    coupling: Coupling = Coupling()
    control: Control = Control()
    genome: Genome = Genome()
    task: Task = Task()
    archive: Archive = Archive()
    search: Search = Search()

    @model_validator(mode="after")
    def refuse_too_large_a_body(self) -> Self:
        """However it turns, the stretched body and the delta's support must fit in."""
        needed = ceil(self.body.length * (1 + self.control.length_scale) + SUPPORT)
        side = "width" if self.world.width <= self.world.height else "height"
        if needed > getattr(self.world, side):
            raise ValueError(
                f"`world.{side}` must be at least {needed} cells for `body.nodes` = "
                f"{self.body.nodes} at `body.spacing` = {self.body.spacing:g}, stretched by "
                f"`control.length_scale` = {self.control.length_scale:g}; "
                f"got {getattr(self.world, side)}"
            )
        return self


DEMO = QualityDiversity(
    world=World(width=32, height=32),
    body=Body(nodes=16),
    control=Control(period=50, angle_scale=0.3, length_scale=0.2),
    task=Task(steps=100),
    archive=Archive(
        descriptors=(
            Descriptor(name="bending_effort", bins=16),
            Descriptor(name="stretching_effort", bins=16),
        )
    ),
    search=Search(generations=400, batch=16),
)

PAPER = QualityDiversity(
    coupling=Coupling(projection="none", theta_feedback=0),
    control=Control(timer="linear", position="unit", angle_scale=0.5, length_scale=0.3),
    archive=Archive(
        descriptors=(
            Descriptor(name="bending_effort", low=0, high=0.5, scale="linear"),
            Descriptor(name="stretching_effort", low=0, high=0.15, scale="linear"),
        )
    ),
)

PRESETS = {
    "demo": ("A small demonstration, under a minute on a laptop", DEMO),
    "standard": (
        "32 nodes in 64 × 64 cells, force- and torque-free coupling",
        QualityDiversity(),
    ),
    "paper": (
        "As in the paper: linear timer, linear efforts, free edge angles, no projection",
        PAPER,
    ),
}
