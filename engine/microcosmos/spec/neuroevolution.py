"""The spec of a NEAT run, and its presets."""

from typing import Literal, Self

from pydantic import Field, model_validator

from .base import Part
from .body import Body, Chain
from .control import Control, Genome
from .coupling import Coupling
from .emitters import PopulationEmitter, refuse_unfit_emitters
from .encodings import Controller, refuse_cramped
from .fields import Energy, Steric
from .scene import Scene, refuse_misfit, refuse_senseless
from .search import Archive, Generations, Task
from .world import World


class Neuroevolution(Part):
    """NEAT over swimmers: one population that gets fitter; an archive looks on."""

    experiment: Literal["neuroevolution"] = "neuroevolution"
    seed: int = Field(default=0, ge=0, lt=2**32)
    """The one source of randomness."""
    world: World = World()
    body: Body = Chain()
    coupling: Coupling = Coupling()
    control: Controller = Control()
    genome: Genome = Genome()
    task: Task = Task()
    archive: Archive = Archive()
    """Where the best creature of each kind is kept; it has no part in the search."""
    neat: PopulationEmitter = PopulationEmitter()
    search: Generations = Generations(batch=150)
    """The population is a batch."""

    @model_validator(mode="after")
    def check_scene(self) -> Self:
        refuse_misfit(self.world, self.body, self.control)
        refuse_cramped(self.control, self.genome)
        refuse_senseless(self.world, self.control, self.task)
        refuse_unfit_emitters(self.emitters, self.control.encoding)
        return self

    @property
    def generations(self) -> int:
        """Generations of the whole run."""
        return self.search.generations

    @property
    def emitters(self) -> tuple[PopulationEmitter, ...]:
        """The population alone."""
        return (self.neat,)

    @property
    def slots(self) -> tuple[int, ...]:
        """The population is all of a generation."""
        return (self.search.batch,)

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


DEMO = Neuroevolution(
    world=World(width=32, height=32),
    body=Chain(nodes=16),
    control=Control(period=50, angle_scale=0.3, length_scale=0.2),
    task=Task(steps=100),
    search=Generations(generations=100, batch=32),
)

LITERAL = {
    "coupling": Coupling(projection="none", theta_feedback=0, layers=2),
    "control": Control(timer="linear", position="unit", angle_scale=0.5, length_scale=0.3),
}

PRESETS = {
    "demo": ("A small demonstration, under a minute on a laptop", DEMO),
    "standard": ("150 networks of 32 nodes in 64 × 64 cells", Neuroevolution()),
    "paper": (
        "As in the paper: total displacement; two layers, not force-free",
        Neuroevolution(world=World(steric=Steric()), **LITERAL),
    ),
    "paper-energy": (
        "As in the paper: displacement and energy collected, 1 : 1, the energy sensed",
        Neuroevolution(
            world=World(steric=Steric(), energy=Energy()),
            task=Task(fitness="displacement+energy", energy_weight=1.0),
            **{
                **LITERAL,
                "control": LITERAL["control"].model_copy(update={"sense_energy": True}),
            },
        ),
    ),
}
