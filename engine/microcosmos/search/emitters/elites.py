"""Children of elites, newcomers, and random search as a baseline."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from ...genomes import Genotype
from ..insertion import Elites
from .emitter import NO_PARENT, OPERATORS, Children, Keys, Stateless

T = TypeVar("T")

Newcomer = Callable[..., Any]
"""`newcomer(key=...)` makes a random genotype."""


def newcomers(newcomer: Newcomer, keys: Keys) -> Children:
    """Draw random genotypes, one for each key."""
    genotypes = jax.vmap(lambda key: newcomer(key=key))(keys)
    return parentless(genotypes, keys.shape[0], "random")


def parentless(genotypes: Genotype, slots: int, name: str) -> Children:
    """Return children of an operator without known parents."""
    parents = jnp.full((slots, 2), NO_PARENT, jnp.int32)
    return Children(genotypes, parents, jnp.full(slots, OPERATORS.index(name), jnp.int32))


def children(genotypes: Genotype, parents: list[Int[Array, "slot"]], name: str) -> Children:
    """Return children of an operator and one or two parents, given as cells."""
    first, second = (*parents, jnp.full_like(parents[0], NO_PARENT))[:2]
    pairs = jnp.stack([first, second], 1).astype(jnp.int32)
    return Children(genotypes, pairs, jnp.full(len(first), OPERATORS.index(name), jnp.int32))


def or_newcomers(archive: Elites, varied: T, fresh: T) -> T:
    """Return the varied children, or the fresh ones if the archive is empty."""
    any_elite = jnp.any(archive.occupied)
    return jax.tree.map(lambda one, other: jnp.where(any_elite, one, other), varied, fresh)


@dataclass(frozen=True)
class Random(Stateless):
    """New random genotypes in every generation."""

    slots: int
    newcomer: Newcomer

    def emit(self, state: None, archive: Elites, *, keys: Keys) -> tuple[Children, None, None]:
        return newcomers(self.newcomer, keys), None, None
