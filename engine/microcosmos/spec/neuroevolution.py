"""The spec of a NEAT run, and its presets."""

from typing import Literal

from .emitters import PopulationEmitter
from .evolution import LITERAL, SMALL, Evolution
from .search import Generations, Task
from .world import Energy


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


LITERAL_SEARCH = Generations(batch=150, feasible=False)

PRESETS = {
    "demo": (
        "A small demonstration, under a minute on a laptop",
        Neuroevolution(**SMALL, search=Generations(generations=100, batch=32)),
    ),
    "standard": (
        "150 networks that drive a body of 24 nodes in 48 × 48 cells",
        Neuroevolution(),
    ),
    "paper": (
        "As in the paper: total displacement; two layers, not force-free",
        Neuroevolution(**LITERAL, search=LITERAL_SEARCH),
    ),
    "paper-energy": (
        "As in the paper: displacement and energy collected, 1 : 1, the energy sensed",
        Neuroevolution(
            world=LITERAL["world"].model_copy(update={"energy": Energy()}),
            body=LITERAL["body"],
            coupling=LITERAL["coupling"],
            control=LITERAL["control"].model_copy(update={"sense_energy": True}),
            search=LITERAL_SEARCH,
            task=Task(steps=500, fitness="displacement+energy", energy_weight=1.0),
        ),
    ),
}
