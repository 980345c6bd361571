"""Emitters that learn nothing: random genotypes, and variation of elites.

Numbers vary by steps and lines, networks by NEAT's mutations and crossover.
"""

from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ... import neat
from ...bounds import refuse_beyond, refuse_uncountable
from ...genomes import Graph, Vector
from ...operators import OPERATORS
from ..insertion import Elites
from .emitter import (
    NO_PARENT,
    Children,
    Keys,
    Newcomer,
    Problem,
    Stateless,
    children,
    newcomers,
    or_newcomers,
)
from .selection import Select, draw, refuse_unknown


@dataclass(frozen=True)
class Random(Stateless):
    """New random genotypes in every generation: a baseline that learns nothing."""

    slots: int
    newcomer: Newcomer

    def __post_init__(self) -> None:
        refuse_uncountable(1, slots=self.slots)

    def emit(self, state: None, archive: Elites, *, keys: Keys) -> tuple[Children, None, None]:
        return newcomers(self.newcomer, keys), None, None


@dataclass(frozen=True)
class IsoLine(Stateless):
    """x + σ₁ N(0, I) + σ₂ (y − x) N(0, 1): Vassiliades and Mouret, GECCO 2018, eq. 3.

    Parents are elites. Genes stay within −1 and 1. Without a line it is a Gaussian mutation.
    """

    slots: int
    newcomer: Newcomer
    iso: float
    line: float = 0.0
    select: Select = "uniform"

    def __post_init__(self) -> None:
        refuse_uncountable(1, slots=self.slots)
        refuse_beyond(0, iso=self.iso, line=self.line)
        refuse_unknown(self.select)

    def emit(self, state: None, archive: Elites, *, keys: Keys) -> tuple[Children, None, None]:
        def varied() -> Children:
            values, *cells = jax.vmap(lambda key: self._child(archive, key=key))(keys)
            parents, name = (cells, "iso+line") if self.line else (cells[:1], "gaussian")
            return children(Vector(values), parents, name)

        fresh = partial(newcomers, self.newcomer, keys)
        # A branch and not `or_newcomers`, which draws newcomers in every generation.
        return jax.lax.cond(jnp.any(archive.occupied), varied, fresh), None, None

    def _child(
        self, archive: Elites, *, key: PRNGKeyArray
    ) -> tuple[Float[Array, "gene"], Int[Array, ""], Int[Array, ""]]:
        one_key, other_key, iso_key, line_key = jax.random.split(key, 4)
        genes = archive.genotypes
        assert isinstance(genes, Vector)
        one, other = (draw(archive, self.select, key=key) for key in (one_key, other_key))
        x, y = genes.values[one], genes.values[other]
        step = self.iso * jax.random.normal(iso_key, x.shape, x.dtype)
        along = self.line * jax.random.normal(line_key, (), x.dtype)
        return jnp.clip(x + step + along * (y - x), -1.0, 1.0), one, other


@dataclass(frozen=True)
class Neat(Stateless):
    """Mutated elites, some of them crossed with another one first."""

    slots: int
    newcomer: Newcomer
    rates: neat.Rates
    inputs: int
    crossover: float = 0.0
    """Probability that a child has two parents."""
    select: Select = "uniform"

    def __post_init__(self) -> None:
        refuse_uncountable(1, slots=self.slots, inputs=self.inputs)
        refuse_beyond(0, 1, crossover=self.crossover)
        refuse_unknown(self.select)

    def emit(
        self, state: None, archive: Elites, *, keys: Keys
    ) -> tuple[Children, None, neat.Novelty]:
        def child(key):
            select_key, mutate_key = jax.random.split(key)
            cell = draw(archive, self.select, key=select_key)
            parent, other = _network(archive, cell), jnp.asarray(NO_PARENT)
            if self.crossover:
                parent, other = self._crossed(archive, cell, key=key)
            network, novelty = neat.mutate(parent, self.rates, self.inputs, key=mutate_key)
            return network, novelty, cell, other

        networks, novelty, first, second = jax.vmap(child)(keys)
        varied = children(networks, [first, second], "neat")
        crossed = OPERATORS.index("crossover")
        operator = jnp.where(second == NO_PARENT, varied.operator, crossed)
        varied = Children(varied.genotypes, varied.parents, operator)
        fresh = newcomers(self.newcomer, keys), neat.no_novelty(novelty, self.slots)
        offspring, novelty = or_newcomers(archive, (varied, novelty), fresh)
        return offspring, None, novelty

    def _crossed(self, archive: Elites, cell: Int[Array, ""], *, key: PRNGKeyArray):
        whether, which, cross_key = jax.random.split(jax.random.fold_in(key, 1), 3)
        other = draw(archive, self.select, key=which)
        happens = jax.random.bernoulli(whether, self.crossover) & (other != cell)
        fitter = archive.fitness[cell] >= archive.fitness[other]
        pair = jnp.where(fitter, cell, other), jnp.where(fitter, other, cell)
        one, two = (_network(archive, chosen) for chosen in pair)
        crossed = neat.crossover(one, two, key=cross_key)
        parent = _network(archive, cell)
        parent = jax.tree.map(lambda a, b: jnp.where(happens, a, b), crossed, parent)
        return parent, jnp.where(happens, other, NO_PARENT)


Selecting = IsoLine | Neat
"""Emitters that draw their parents from any archive."""


def _network(archive: Elites, cell: Int[Array, ""]) -> Graph:
    network = jax.tree.map(lambda x: x[cell], archive.genotypes)
    assert isinstance(network, Graph)
    return network


def build_random(settings: Any, problem: Problem) -> Random:
    return Random(problem.slots, problem.newcomer)


def build_line(settings: Any, problem: Problem) -> IsoLine:
    given = problem.slots, problem.newcomer, settings.iso, settings.line
    return IsoLine(*given, select=settings.select)


def build_gaussian(settings: Any, problem: Problem) -> IsoLine:
    return IsoLine(problem.slots, problem.newcomer, settings.step, select=settings.select)


def build_neat(settings: Any, problem: Problem) -> Neat:
    given = problem.slots, problem.newcomer, problem.rates, problem.inputs
    return Neat(*given, settings.crossover, settings.select)
