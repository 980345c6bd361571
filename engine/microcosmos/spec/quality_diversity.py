"""The spec of a quality-diversity run, its presets, and what it will need."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part
from .body import Body, Chain
from .control import Control, Genome
from .coupling import Coupling
from .emitters import Emitter, refuse_unfit_emitters
from .encodings import Controller, refuse_cramped
from .fields import Steric
from .scene import Scene, refuse_misfit, refuse_senseless
from .search import Archive, Descriptor, Search, Task, refuse_flat
from .world import World


class QualityDiversity(Part):
    """MAP-Elites over CPPN-controlled swimmers."""

    experiment: Literal["quality-diversity"] = "quality-diversity"
    seed: int = Field(default=0, ge=0, lt=2**32)
    """The one source of randomness."""
    world: World = World()
    body: Body = Chain()
    coupling: Coupling = Coupling()
    control: Controller = Control()
    genome: Genome = Genome()
    task: Task = Task()
    archive: Archive = Archive()
    search: Search = Search()

    @model_validator(mode="after")
    def check_scene(self) -> Self:
        refuse_misfit(self.world, self.body, self.control)
        refuse_cramped(self.control, self.genome)
        refuse_senseless(self.world, self.control, self.task)
        refuse_unfit_emitters(self.search.emitters, self.control.encoding)
        refuse_flat(self.archive, self.search.emitters)
        return self

    @property
    def generations(self) -> int:
        """Generations of the whole run."""
        return self.search.generations

    @property
    def emitters(self) -> tuple[Emitter, ...]:
        """Where children come from."""
        return self.search.emitters

    @property
    def slots(self) -> tuple[int, ...]:
        """Children of each emitter in a generation."""
        return self.search.slots

    @property
    def scene(self) -> Scene:
        """What is simulated for each creature."""
        return Scene(
            world=self.world,
            body=self.body,
            coupling=self.coupling,
            control=self.control,
            task=self.task,
        )


DEMO = QualityDiversity(
    world=World(width=32, height=32),
    body=Chain(nodes=16),
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
    world=World(steric=Steric()),
    coupling=Coupling(projection="none", theta_feedback=0, layers=2),
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
        "As in the paper: linear timer and efforts, two layers, repulsion; not force-free",
        PAPER,
    ),
}
