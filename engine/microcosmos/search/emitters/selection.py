"""Selection of parents among the elites of an archive."""

from typing import Literal

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, PRNGKeyArray

from ..insertion import Elites

Select = Literal["uniform", "mixed", "tournament"]
TOURNAMENTS = {"uniform": 0.0, "mixed": 0.5, "tournament": 1.0}
"""The share of parents that have won a tournament."""
ENTRANTS = 3
"""Elites in a tournament."""


def draw(archive: Elites, select: Select = "uniform", *, key: PRNGKeyArray) -> Int[Array, ""]:
    """Draw an occupied cell, each with equal probability, or the fittest of three such draws.

    Returns 0 where no cell is occupied.
    """
    share = TOURNAMENTS[select]
    if not share:
        return _uniform(archive, key)
    entrants_key, either_key = jax.random.split(key)
    cells = jax.vmap(lambda key: _uniform(archive, key))(
        jax.random.split(entrants_key, ENTRANTS)
    )
    winner = cells[jnp.argmax(archive.fitness[cells])]
    return jnp.where(jax.random.bernoulli(either_key, share), winner, cells[0])


def _uniform(archive: Elites, key: PRNGKeyArray) -> Int[Array, ""]:
    rank = jax.random.randint(key, (), 0, jnp.maximum(1, jnp.sum(archive.occupied)))
    return jnp.argmax(jnp.cumsum(archive.occupied) > rank)
