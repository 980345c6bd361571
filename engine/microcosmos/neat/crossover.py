"""Crossover by alignment of genes (Stanley and Miikkulainen 2002, section 3.2)."""

from dataclasses import replace

import jax.numpy as jnp
from jaxtyping import Array, Int, PRNGKeyArray

from ..genomes import CPPN
from .rng import draws, rescaled
from .rows import match


def crossover(
    fitter: CPPN,
    other: CPPN,
    average: float = 0.0,
    disabled: float = 0.75,
    *,
    key: PRNGKeyArray,
) -> CPPN:
    """Return a child with the structure of the fitter parent, and matching genes of either.

    Genes match where their numbers are equal. Of equally fit parents the first counts as the
    fitter; the paper draws each unmatched gene of both, whose union may have a cycle. The child
    has a cycle only if the fitter parent has. With probability `average`, weights and biases of
    matching genes are means, and with probability `disabled` a gene disabled in either parent
    is disabled in the child.
    """
    mean, swapped, gene = draws((), fitter.bias.shape, fitter.weight.shape, key=key)
    connection = match(
        fitter.innovation, fitter.connection_used, other.innovation, other.connection_used
    )
    node = match(fitter.node_id, fitter.node_used, other.node_id, other.node_used)
    mean, swapped, taken = mean < average, swapped < 0.5, gene < 0.5
    uniform = rescaled(jnp.where(taken, gene, gene - 0.5), 0.0, 0.5)
    off = ~fitter.enabled | ((connection >= 0) & ~other.enabled[connection])
    return replace(
        fitter,
        activation=jnp.where(swapped & (node >= 0), other.activation[node], fitter.activation),
        bias=_mixed(fitter.bias, other.bias, node, swapped, mean),
        enabled=fitter.connection_used & (~off | (uniform >= disabled)),
        weight=_mixed(fitter.weight, other.weight, connection, taken, mean),
    )


def _mixed(values, others, row: Int[Array, "gene"], taken, mean):
    """Return values of either parent, or their mean; without a match, those of the fitter."""
    other = others[row]
    mixed = jnp.where(mean, values + (other - values) / 2, jnp.where(taken, other, values))
    return jnp.where(row >= 0, mixed, values)
