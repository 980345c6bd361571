"""Rates of mutations, the distribution of new genes, and settings of a population."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from ..bounds import refuse_beyond
from ..genomes import ACTIVATIONS
from .alignment import Coefficients
from .plans import PlanRates
from .rows import LARGEST, Uniform

Draw = Callable[[Array], Array]
"""A function from uniform numbers in [0, 1) to random numbers around zero."""


def normal(uniform: Uniform) -> Array:
    """Return normal numbers with mean 0 and deviation 1."""
    # The quantile of 0 is −∞: the bound keeps the least draw finite.
    return np.sqrt(2) * jax.lax.erf_inv(jnp.maximum(2 * uniform - 1, -LARGEST))


def uniform(uniform: Uniform) -> Array:
    """Return uniform numbers between −1 and 1."""
    return 2 * uniform - 1


def one_of(palette: tuple[int, ...], uniform: Uniform) -> Array:
    """Return uniformly drawn activations of the palette."""
    place = jnp.floor(uniform * len(palette)).astype(jnp.int32)
    return jnp.asarray(np.asarray(palette, np.int32))[place]


CHANCES = (
    *("weight", "replace", "activation", "toggle", "add_node", "add_connection"),
    *("delete_node", "delete_connection", "values"),
)
"""Rates that are probabilities."""


@dataclass(frozen=True)
class Rates:
    """Probabilities per gene (values, activations, toggles) or per child (structure).

    Raises `InvalidField` for a probability beyond 0 to 1, and for a step below 0.
    """

    weight: float
    """A weight or bias is perturbed."""
    weight_step: float
    """Factor on a drawn number that perturbs a weight or bias."""
    replace: float
    """A weight or bias is drawn anew."""
    new_step: float = field(default=1.0, kw_only=True)
    """Factor on a drawn number that replaces a weight or bias."""
    activation: float
    toggle: float
    add_node: float
    add_connection: float
    delete_node: float = 0.0
    delete_connection: float = 0.0
    values: float = 1.0
    """Probability that the weights and biases of a child vary."""
    separate: bool = False
    """Keep values where a node or connection is added, so that fitness tests that alone."""
    bound: float | None = None
    """Limit of the size of weights and biases."""

    def __post_init__(self) -> None:
        refuse_beyond(0, weight_step=self.weight_step, new_step=self.new_step)
        refuse_beyond(0, 1, **{name: getattr(self, name) for name in CHANCES})

    draw: Draw = normal
    palette: tuple[int, ...] = tuple(range(len(ACTIVATIONS)))
    """Indices of the activations that are drawn, in `genomes.ACTIVATIONS`."""
    recurrent: bool = False
    """Allow added connections that close cycles or join a node to itself."""
    blind: bool = False
    """Draw any two nodes for an added connection, and fail where they are joined or would
    close a cycle; otherwise draw among the possible connections."""
    drop_split: bool = False
    """Remove a split connection instead of disabling it."""
    plan: PlanRates | None = None
    """Rates of a body plan; None: genotypes have none."""


def bounded(values: Array, rates: Rates) -> Array:
    """Clip weights or biases to the limit."""
    return values if rates.bound is None else jnp.clip(values, -rates.bound, rates.bound)


SIGMOID = tuple(ACTIVATIONS).index("sigmoid")


@dataclass(frozen=True)
class Settings:
    """Settings of speciation, selection and variation."""

    rates: Rates
    coefficients: Coefficients
    population: int
    threshold: float
    """Compatibility distance within which networks belong to one species."""
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
