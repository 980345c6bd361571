"""Alignment of genes by number: crossover and distance of networks.

Stanley and Miikkulainen 2002, sections 3.2 and 3.3.
"""

from dataclasses import dataclass, replace

import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ..genomes import CPPN
from .rows import draws, match, rescaled


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
    # The draw that chose a parent, rescaled within its half, also decides what is disabled.
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


@dataclass(frozen=True)
class Coefficients:
    """Coefficients of the distance."""

    excess: float
    disjoint: float
    weight: float
    small: int = 0
    """Networks with at most this many connections have N = 1 in the distance."""
    totals: bool = False
    """TensorNEAT's form: nodes count as well as connections, and differences of matching
    genes are summed and divided by the number of genes, not averaged."""


def distance(a: CPPN, b: CPPN, coefficients: Coefficients) -> Float[Array, ""]:
    """Return c₁E/N + c₂D/N + c₃W̄ (their equation 1), or the form of `totals`.

    E, D: excess and disjoint connection genes; W̄: mean weight difference of matching ones,
    0 where none match; N: genes of the larger network.
    """
    row = match(a.innovation, a.connection_used, b.innovation, b.connection_used)
    unlike = jnp.where(row >= 0, jnp.abs(a.weight - b.weight[row]), 0.0)
    matching, size_a, size_b = (
        jnp.sum(used) for used in (row >= 0, a.connection_used, b.connection_used)
    )
    larger = jnp.maximum(size_a, size_b)
    unmatched = size_a + size_b - 2 * matching
    if coefficients.totals:
        links = coefficients.disjoint * unmatched + coefficients.weight * jnp.sum(unlike)
        return links / jnp.maximum(1, larger) + _between_nodes(a, b, coefficients)
    excess = _beyond(a, b) + _beyond(b, a)
    many = jnp.where(larger <= coefficients.small, 1, jnp.maximum(1, larger))
    structure = coefficients.excess * excess + coefficients.disjoint * (unmatched - excess)
    mean = jnp.sum(unlike) / jnp.maximum(1, matching)
    return structure / many + coefficients.weight * mean


def _beyond(a: CPPN, b: CPPN):
    """Return the number of a's connections whose numbers are above all of b's."""
    last = jnp.max(jnp.where(b.connection_used, b.innovation, -1))
    return jnp.sum(a.connection_used & (a.innovation > last))


def _between_nodes(a: CPPN, b: CPPN, coefficients: Coefficients):
    """Return the distance of nodes: bias differences, and 1 for each different activation."""
    row = match(a.node_id, a.node_used, b.node_id, b.node_used)
    unlike = jnp.abs(a.bias - b.bias[row]) + (a.activation != b.activation[row])
    unlike = jnp.sum(jnp.where(row >= 0, unlike, 0.0))
    size_a, size_b, matching = (jnp.sum(u) for u in (a.node_used, b.node_used, row >= 0))
    total = coefficients.disjoint * (size_a + size_b - 2 * matching)
    return (total + coefficients.weight * unlike) / jnp.maximum(1, jnp.maximum(size_a, size_b))
