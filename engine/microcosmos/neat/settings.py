"""All settings of a NEAT population, and the two presets."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from ..genomes import ACTIVATIONS
from .distance import Coefficients
from .rates import Rates, uniform

SIGMOID = tuple(ACTIVATIONS).index("sigmoid")


@dataclass(frozen=True)
class Settings:
    """How a population is divided, selected and varied."""

    rates: Rates
    coefficients: Coefficients
    population: int
    threshold: float
    """Distance within which networks are of one species; the first one where it moves."""
    target_species: int
    """The number of species that the threshold moves towards; 0 keeps it fixed."""
    threshold_step: float
    max_species: int
    representative: Literal["random", "nearest"]
    """A member drawn at random, or the one nearest to the representative before."""
    stagnation: int
    """Generations without a better network after which a species has no children."""
    population_stagnation: int
    """The same for all species but the best two, once the population stagnates; 0: never."""
    species_elitism: int
    """So many best species never stagnate; one at least."""
    allotment: Literal["sharing", "rank"]
    """Children of a species in proportion to its mean fitness, or to its place by best."""
    inertia: float
    """How much of its present size a species keeps; 0: it takes what is allotted."""
    min_size: int
    """Children of each species that has any."""
    elites: int
    """Best networks of a species that are copied unchanged."""
    elite_size: int
    """Members that a species must have for that."""
    survival: float
    """Best share of a species from which parents are drawn."""
    crossover: float
    """Probability that a child has two parents."""
    interspecies: float
    """Probability that the second one is of any species."""
    crossover_only: float
    """Probability that a child of two parents is not mutated."""
    average: float
    disabled: float
    """See `crossover`."""


PAPER = Settings(
    rates=Rates(
        weight=1.0,
        weight_step=2.5,
        replace=0.1,
        new_step=2.5,
        activation=0.0,
        toggle=0.0,
        add_node=0.03,
        add_connection=0.05,
        values=0.8,
        apart=True,
        bound=8.0,
        draw=uniform,
        palette=(SIGMOID,),
    ),
    coefficients=Coefficients(excess=1.0, disjoint=1.0, weight=0.4, small=19),
    population=150,
    threshold=3.0,
    target_species=0,
    threshold_step=0.0,
    max_species=50,
    representative="random",
    stagnation=15,
    population_stagnation=0,
    species_elitism=1,
    allotment="sharing",
    inertia=0.0,
    min_size=0,
    elites=1,
    elite_size=6,
    survival=0.2,
    crossover=0.75,
    interspecies=0.001,
    crossover_only=0.2,
    average=0.0,
    disabled=0.75,
)
"""The XOR experiment of Stanley and Miikkulainen (2002), section 4.1.

Not in the paper, but in the authors' program: the step of weights, also of new ones, that
they stay where structure is added, and the shares of survivors and of children that are only
crossed. Ours: a stagnant population keeps all its species (the paper keeps two after 20
generations, with which XOR was solved less often), weights stay within 8, the best species
never stagnates, and species are at most 50.
"""

TENSORNEAT = Settings(
    rates=Rates(
        weight=0.2,
        weight_step=0.15,
        replace=0.015,
        activation=0.1,
        toggle=0.0,
        add_node=0.1,
        add_connection=0.2,
        delete_node=0.1,
        delete_connection=0.2,
        bound=5.0,
        palette=(SIGMOID,),
        blind=True,
        drop_split=True,
    ),
    coefficients=Coefficients(excess=1.0, disjoint=1.0, weight=0.4, totals=True),
    population=1000,
    threshold=2.0,
    target_species=0,
    threshold_step=0.0,
    max_species=10,
    representative="nearest",
    stagnation=15,
    population_stagnation=0,
    species_elitism=2,
    allotment="rank",
    inertia=0.5,
    min_size=1,
    elites=2,
    elite_size=1,
    survival=0.1,
    crossover=1.0,
    interspecies=0.0,
    crossover_only=0.0,
    average=0.0,
    disabled=0.75,
)
"""The defaults of TensorNEAT 0.1.0, as far as its networks have what ours have."""

PRESETS: Mapping[str, Settings] = MappingProxyType({"paper": PAPER, "tensorneat": TENSORNEAT})
