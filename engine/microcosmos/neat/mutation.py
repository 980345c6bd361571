"""NEAT's mutations of one network (Stanley and Miikkulainen 2002, section 3.1).

As in the paper, networks grow, and a connection is removed by disabling it; with rates of
deletion, genes are also lost. `numbering` numbers new genes for a whole generation.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..genomes import CPPN
from .plans import PlanNovelty
from .rows import NONE, Uniform, barrier, draws, rescaled
from .settings import Rates, bounded, one_of
from .structure import add_connection, add_node, delete_connection, delete_node

DECISIONS = 10
"""Draws per child beside those per gene."""


class Novelty(eqx.Module):
    """The new genes of children, and the marks by which equal ones get equal numbers."""

    connection_row: Int[Array, "*batch"]
    """Row of the added connection, or −1; its ends identify it."""
    split_row: Int[Array, "*batch"]
    """Row of the first of a new node's two connections, or −1."""
    node_row: Int[Array, "*batch"]
    split_innovation: Int[Array, "*batch"]
    """Number of the split connection, or −1."""
    segment: PlanNovelty | None = None
    """The new segment of a plan; None where genotypes have no plan."""


def no_novelty(like: Novelty, children: int) -> Novelty:
    """Return the novelty of children without new genes, with the fields of `like`."""
    return jax.tree.map(lambda x: jnp.full((children, *x.shape[1:]), NONE, x.dtype), like)


def mutate(
    network: CPPN, rates: Rates, inputs: int, outputs: int | None = None, *, key: PRNGKeyArray
) -> tuple[CPPN, Novelty]:
    """Return a child of one parent, and its genes that need numbers.

    Raises `ValueError` if nodes can be deleted and the number of `outputs`, which are never
    deleted, is not given.
    """
    if rates.delete_node and outputs is None:
        raise ValueError("`outputs` must be given where `delete_node` is above 0, got None")
    nodes, genes = network.bias.shape, network.weight.shape
    values, activations, toggles, choice = draws(
        (nodes[0] + genes[0],), nodes, genes, (DECISIONS,), key=key
    )
    if rates.delete_node:
        network = delete_node(network, rates.delete_node, inputs + (outputs or 0), choice[0])
    if rates.delete_connection:
        network = delete_connection(network, rates.delete_connection, choice[1])
    network = barrier(network)
    # Chosen before connections are added: a new one is not split in the same generation.
    splittable = network.connection_used & network.enabled
    vary, link = choice[2] < rates.values, choice[3] < rates.add_connection
    node = choice[4] < rates.add_node
    if rates.separate:
        vary = vary & ~link & ~node
    network = mutate_values(network, vary, rates, inputs, values)
    network = mutate_activations(network, rates, inputs, activations)
    network = toggle_connections(network, rates.toggle, toggles)
    network = barrier(network)
    network, connection_row = barrier(add_connection(network, link, rates, inputs, choice[5:8]))
    network, split_row, node_row, split = add_node(
        network, splittable & network.enabled, node, rates, choice[8:10]
    )
    if rates.drop_split:  # The split connection stood above the added one.
        connection_row = connection_row - ((connection_row >= 0) & (split_row >= 0))
    return network, Novelty(connection_row, split_row, node_row, split)


def mutate_values(
    network: CPPN, happens: Bool[Array, ""], rates: Rates, inputs: int, uniform: Uniform
) -> CPPN:
    """Perturb or redraw weights, and the biases of nodes that are not inputs."""
    node = jnp.arange(network.node_used.shape[0])
    weights = network.connection_used & happens
    biases = network.node_used & (node >= inputs) & happens
    return replace(
        network,
        weight=_vary(network.weight, weights, rates, uniform[len(node) :]),
        bias=_vary(network.bias, biases, rates, uniform[: len(node)]),
    )


def mutate_activations(network: CPPN, rates: Rates, inputs: int, uniform: Uniform) -> CPPN:
    """Redraw the activations of some nodes."""
    if not rates.activation:
        return network
    node = jnp.arange(network.node_used.shape[0])
    chosen = (uniform < rates.activation) & network.node_used & (node >= inputs)
    drawn = one_of(rates.palette, rescaled(uniform, 0.0, rates.activation))
    return replace(network, activation=jnp.where(chosen, drawn, network.activation))


def toggle_connections(network: CPPN, rate: float, uniform: Uniform) -> CPPN:
    """Enable or disable some connections."""
    if not rate:
        return network
    return replace(
        network, enabled=network.enabled ^ ((uniform < rate) & network.connection_used)
    )


def _vary(
    values: Float[Array, "gene"], used: Bool[Array, "gene"], rates: Rates, uniform: Uniform
) -> Float[Array, "gene"]:
    """Perturb or redraw genes; one draw decides and, rescaled, gives the step or value."""
    new, either = rates.replace, rates.replace + (1 - rates.replace) * rates.weight
    replaced, perturbed = rescaled(uniform, 0.0, new), rescaled(uniform, new, either)
    drawn = rates.draw(jnp.where(uniform < new, replaced, perturbed)).astype(values.dtype)
    varied = jnp.where(uniform < either, values + rates.weight_step * drawn, values)
    varied = jnp.where(uniform < new, rates.new_step * drawn, varied)
    return jnp.where(used, bounded(varied, rates), values)
