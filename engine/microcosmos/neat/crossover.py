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
    mean_key, node_key, gene_key = jax.random.split(key, 3)
    connection = match(
        fitter.innovation, fitter.connection_used, other.innovation, other.connection_used
    )
    node = match(fitter.node_id, fitter.node_used, other.node_id, other.node_used)
    mean = jax.random.bernoulli(mean_key, average)
    swapped = jax.random.bits(node_key, node.shape, "uint8") < 128
    bits = jax.random.bits(gene_key, connection.shape, "uint32")
    taken, chance = bits & 1 == 1, (bits >> 1).astype(jnp.float32) / 2.0**31
    off = ~fitter.enabled | ((connection >= 0) & ~other.enabled[connection])
    return replace(
        fitter,
        activation=jnp.where(swapped & (node >= 0), other.activation[node], fitter.activation),
        bias=_mixed(fitter.bias, other.bias, node, swapped, mean),
        enabled=fitter.connection_used & (~off | (chance >= disabled)),
        weight=_mixed(fitter.weight, other.weight, connection, taken, mean),
    )


def _mixed(own, others, row: Int[Array, "gene"], taken, mean):
    """Values from either parent, or halfway; without a match the own ones."""
    other = others[row]
    mixed = jnp.where(mean, own + (other - own) / 2, jnp.where(taken, other, own))
    return jnp.where(row >= 0, mixed, own)
