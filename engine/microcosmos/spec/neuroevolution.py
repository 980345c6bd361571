"""The spec of a NEAT run, and its presets."""

from typing import Literal

from .body import Chain
from .control import Control
from .coupling import Coupling
from .emitters import PopulationEmitter
from .evolution import Evolution
from .search import Generations, Task
from .world import Energy, Steric, World


class Neuroevolution(Evolution[Literal["neuroevolution"], Generations]):
    """NEAT over swimmers: one population becomes fitter; the archive records its elites."""

    experiment: Literal["neuroevolution"] = "neuroevolution"
    search: Generations = Generations(batch=150)
    """Generations; the batch is the population."""
    neat: PopulationEmitter = PopulationEmitter()

    @property
    def emitters(self) -> tuple[PopulationEmitter, ...]:
        return (self.neat,)

    @property
    def slots(self) -> tuple[int, ...]:
        return (self.search.batch,)


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
