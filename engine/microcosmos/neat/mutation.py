"""NEAT's mutations of one network (Stanley and Miikkulainen 2002, section 3.1).

As in the paper networks grow, and a connection is removed by disabling it; where rates of
deletion are given, genes can be lost as well. A new gene has no number yet: `numbering`
gives it one that all of the generation share.
"""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..genomes import CPPN
from .rates import Rates, one_of
from .rows import NONE
from .structure import add_connection, add_node, delete_connection, delete_node


class Novelty(eqx.Module):
    """The genes that arose in children, by what identifies them in a generation."""

    connection_row: Int[Array, "*batch"]
    """Where the added connection stands, or −1; its ends identify it."""
    split_row: Int[Array, "*batch"]
    """Where the first of a new node's two connections stands, or −1."""
    node_row: Int[Array, "*batch"]
    split_innovation: Int[Array, "*batch"]
    """The number of the connection that was split, or −1."""


def nothing_new(children: int) -> Novelty:
    """No gene arose in any child."""
    none = jnp.full(children, NONE)
    return Novelty(none, none, none, none)


def mutate(
    network: CPPN, rates: Rates, inputs: int, outputs: int | None = None, *, key: PRNGKeyArray
) -> tuple[CPPN, Novelty]:
    """A child of one parent, and the genes in it that need numbers.

    Raises `ValueError` where nodes can be deleted and the number of `outputs`, which never
    are, is not given.
    """
    keys = jax.random.split(key, 8)
    if rates.delete_node:
        if outputs is None:
            raise ValueError("`outputs` must be given where `delete_node` is above 0, got None")
        network = delete_node(network, rates.delete_node, inputs + outputs, key=keys[5])
    if rates.delete_connection:
        network = delete_connection(network, rates.delete_connection, key=keys[6])
    splittable = network.connection_used & network.enabled
    values, link, node = jax.random.uniform(keys[7], (3,)) < jnp.asarray(
        [rates.values, rates.add_connection, rates.add_node]
    )
    if rates.apart:
        values = values & ~link & ~node
    network = mutate_values(network, values, rates, inputs, key=keys[0])
    network = mutate_activations(network, rates, inputs, key=keys[1])
    network = toggle_connections(network, rates.toggle, key=keys[2])
    network, connection_row = add_connection(network, link, rates, inputs, key=keys[3])
    network, split_row, node_row, split = add_node(
        network, splittable & network.enabled, node, rates, key=keys[4]
    )
    if rates.drop_split:  # The split connection stood above the added one.
        connection_row = connection_row - ((connection_row >= 0) & (split_row >= 0))
    return network, Novelty(connection_row, split_row, node_row, split)


def mutate_values(
    network: CPPN, happens: Bool[Array, ""], rates: Rates, inputs: int, *, key: PRNGKeyArray
) -> CPPN:
    """Perturb or redraw weights, and the biases of nodes that are not inputs."""
    weight_key, bias_key = jax.random.split(key)
    node = jnp.arange(network.node_used.shape[0])
    weights = network.connection_used & happens
    biases = network.node_used & (node >= inputs) & happens
    return replace(
        network,
        weight=_vary(network.weight, weights, rates, key=weight_key),
        bias=_vary(network.bias, biases, rates, key=bias_key),
    )


def mutate_activations(network: CPPN, rates: Rates, inputs: int, *, key: PRNGKeyArray) -> CPPN:
    """Redraw the activations of some nodes."""
    if not rates.activation:
        return network
    which, what = jax.random.split(key)
    node = jnp.arange(network.node_used.shape[0])
    chosen = jax.random.bernoulli(which, rates.activation, node.shape) & network.node_used
    drawn = one_of(rates.palette, node.shape, key=what)
    chosen = chosen & (node >= inputs)
    return replace(network, activation=jnp.where(chosen, drawn, network.activation))


def toggle_connections(network: CPPN, rate: float, *, key: PRNGKeyArray) -> CPPN:
    """Enable or disable some connections."""
    if not rate:
        return network
    chosen = jax.random.bernoulli(key, rate, network.enabled.shape) & network.connection_used
    return replace(network, enabled=network.enabled ^ chosen)


def _vary(
    values: Float[Array, "gene"],
    used: Bool[Array, "gene"],
    rates: Rates,
    *,
    key: PRNGKeyArray,
) -> Float[Array, "gene"]:
    """One draw decides about each gene, another one is its step or its new value."""
    which, what = jax.random.split(key)
    chance = jax.random.uniform(which, values.shape)
    drawn = rates.draw(what, values.shape, values.dtype)
    either = rates.replace + (1 - rates.replace) * rates.weight
    varied = jnp.where(chance < either, values + rates.weight_step * drawn, values)
    varied = jnp.where(chance < rates.replace, drawn, varied)
    if rates.bound is not None:
        varied = jnp.clip(varied, -rates.bound, rates.bound)
    return jnp.where(used, varied, values)
