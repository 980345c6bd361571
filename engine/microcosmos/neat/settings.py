"""Settings of a NEAT population, and two presets."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from ..genomes import ACTIVATIONS
from .distance import Coefficients
from .rates import Rates, uniform

SIGMOID = tuple(ACTIVATIONS).index("sigmoid")


@dataclass(frozen=True)
class Settings:
    """Settings of speciation, selection and variation."""

    rates: Rates
    coefficients: Coefficients
    population: int
    threshold: float
    """Compatibility distance of a species; its initial value where it is adjusted."""
    target_species: int
    """Number of species that the threshold is adjusted towards; 0: fixed threshold."""
    threshold_step: float
    max_species: int
    representative: Literal["random", "nearest"]
    """A random member, or the member nearest to the former representative."""
    stagnation: int
    """Generations without improvement after which a species has no offspring."""
    population_stagnation: int
    """The same for the population, after which only the best two species breed; 0: never."""
    species_elitism: int
    """Number of best species that never stagnate, at least one."""
    allotment: Literal["sharing", "rank"]
    """Offspring in proportion to mean fitness, or to the rank by best fitness."""
    inertia: float
    """Weight of a species' present size in its number of offspring; 0: none."""
    min_size: int
    """Least offspring of a species that has any."""
    elites: int
    """Number of a species' best networks that are copied unchanged."""
    elite_size: int
    """Least members of a species with elites."""
    survival: float
    """Fittest share of a species from which parents are drawn."""
    crossover: float
    """Probability of crossover with a second parent."""
    interspecies: float
    """Probability that the second parent is of any species."""
    crossover_only: float
    """Probability that crossover is not followed by mutation."""
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
        separate=True,
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

From the authors' program, not the paper: the steps of weights, unchanged weights where
structure is added, and the shares of survivors and of crossover without mutation. Changed: a
stagnant population keeps all species (the paper keeps two after 20 generations, which solved
XOR less often), weights stay within 8, the best species never stagnates, at most 50 species.
"""

TENSORNEAT = replace(
    PAPER,
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
    max_species=10,
    representative="nearest",
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
)
"""The defaults of TensorNEAT 0.1.0, as far as they apply to our networks."""

PRESETS: Mapping[str, Settings] = MappingProxyType({"paper": PAPER, "tensorneat": TENSORNEAT})
