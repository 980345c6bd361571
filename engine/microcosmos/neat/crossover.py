"""Crossover by alignment of genes (Stanley and Miikkulainen 2002, section 3.2)."""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, PRNGKeyArray

from ..genomes import CPPN
from .rows import match

DISABLED = 0.75
"""Probability that a gene disabled in either parent is disabled in the child."""


def crossover(
    fitter: CPPN,
    other: CPPN,
    average: float = 0.0,
    disabled: float = DISABLED,
    *,
    key: PRNGKeyArray,
) -> CPPN:
    """A child with all genes of the fitter parent, the matching ones from either.

    Genes match where their numbers are equal; disjoint and excess ones come from the fitter
    parent. So the child has its structure, and holds a cycle only if it does. With
    probability `average` weights and biases of matching genes are means.
    """
    keys = jax.random.split(key, 4)
    connection = match(
        fitter.innovation, fitter.connection_used, other.innovation, other.connection_used
    )
    node = match(fitter.node_id, fitter.node_used, other.node_id, other.node_used)
    mean = jax.random.bernoulli(keys[0], average)
    swapped = jax.random.bernoulli(keys[1], 0.5, node.shape) & (node >= 0)
    taken = jax.random.bernoulli(keys[2], 0.5, connection.shape)
    off = ~fitter.enabled | ((connection >= 0) & ~other.enabled[connection])
    again = off & jax.random.bernoulli(keys[3], 1 - disabled, off.shape)
    return replace(
        fitter,
        activation=jnp.where(swapped, other.activation[node], fitter.activation),
        bias=_mixed(fitter.bias, other.bias, node, swapped, mean),
        enabled=fitter.connection_used & (~off | again),
        weight=_mixed(fitter.weight, other.weight, connection, taken, mean),
    )


def _mixed(own, others, row: Int[Array, "gene"], taken, mean):
    """Values from either parent, or halfway; without a match the own ones."""
    other = others[row]
    mixed = jnp.where(mean, own + (other - own) / 2, jnp.where(taken, other, own))
    return jnp.where(row >= 0, mixed, own)
