"""NEAT's mutations of one network (Stanley and Miikkulainen 2002, section 3.1).

Networks grow and never lose a gene; a connection is removed by disabling it. A new gene
has no number yet: `numbering` gives it one that all of the generation share.
"""

from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Int, PRNGKeyArray

from ..genomes import ACTIVATIONS, CPPN

NONE = -1
"""Stands for the number of a gene that did not arise."""


@dataclass(frozen=True)
class Rates:
    """How often each mutation happens to a child; see `spec.Genome`."""

    weight: float
    weight_step: float
    replace: float
    activation: float
    toggle: float
    add_node: float
    add_connection: float


class Novelty(eqx.Module):
    """The genes that arose in one child, by what identifies them in a generation."""

    connection_row: Int[Array, ""]
    """Where the added connection stands, or −1; its ends identify it."""
    split_row: Int[Array, ""]
    """Where the first of a new node's two connections stands, or −1."""
    node_row: Int[Array, ""]
    split_innovation: Int[Array, ""]
    """The number of the connection that was split, or −1."""


def minimal(
    key: PRNGKeyArray, inputs: int, outputs: int, max_nodes: int, max_connections: int
) -> CPPN:
    """Every input connected to every output; weights and biases have deviation 1."""
    weight_key, bias_key, activation_key = jax.random.split(key, 3)
    node, row = jnp.arange(max_nodes), jnp.arange(max_connections)
    node_used, row_used = node < inputs + outputs, row < inputs * outputs
    is_output = node_used & (node >= inputs)
    drawn = jax.random.randint(activation_key, (max_nodes,), 0, len(ACTIVATIONS))
    return CPPN(
        node_used=node_used,
        node_id=jnp.where(node_used, node, 0),
        activation=jnp.where(is_output, drawn, 0),
        bias=jnp.where(is_output, jax.random.normal(bias_key, (max_nodes,)), 0.0),
        connection_used=row_used,
        innovation=jnp.where(row_used, row, 0),
        source=jnp.where(row_used, row % inputs, 0),
        target=jnp.where(row_used, inputs + row // inputs, 0),
        enabled=row_used,
        weight=jnp.where(row_used, jax.random.normal(weight_key, (max_connections,)), 0.0),
    )


def mutate(
    network: CPPN, rates: Rates, inputs: int, *, key: PRNGKeyArray
) -> tuple[CPPN, Novelty]:
    """A child of one parent, and the genes in it that need numbers."""
    keys = jax.random.split(key, 5)
    splittable = network.connection_used & network.enabled
    network = mutate_values(network, rates, inputs, key=keys[0])
    network = mutate_activations(network, rates.activation, inputs, key=keys[1])
    network = toggle_connections(network, rates.toggle, key=keys[2])
    network, connection_row = add_connection(network, rates.add_connection, inputs, key=keys[3])
    network, split_row, node_row, split = add_node(
        network, splittable & network.enabled, rates.add_node, key=keys[4]
    )
    return network, Novelty(connection_row, split_row, node_row, split)


def mutate_values(network: CPPN, rates: Rates, inputs: int, *, key: PRNGKeyArray) -> CPPN:
    """Perturb or redraw weights, and the biases of nodes that are not inputs."""
    weight_key, bias_key = jax.random.split(key)
    node = jnp.arange(network.node_used.shape[0])
    return replace(
        network,
        weight=_vary(network.weight, network.connection_used, rates, key=weight_key),
        bias=_vary(network.bias, network.node_used & (node >= inputs), rates, key=bias_key),
    )


def mutate_activations(network: CPPN, rate: float, inputs: int, *, key: PRNGKeyArray) -> CPPN:
    """Redraw the activations of some nodes."""
    which, what = jax.random.split(key)
    node = jnp.arange(network.node_used.shape[0])
    chosen = jax.random.bernoulli(which, rate, node.shape) & network.node_used
    drawn = jax.random.randint(what, node.shape, 0, len(ACTIVATIONS))
    chosen = chosen & (node >= inputs)
    return replace(network, activation=jnp.where(chosen, drawn, network.activation))


def toggle_connections(network: CPPN, rate: float, *, key: PRNGKeyArray) -> CPPN:
    """Enable or disable some connections."""
    chosen = jax.random.bernoulli(key, rate, network.enabled.shape) & network.connection_used
    return replace(network, enabled=network.enabled ^ chosen)


def add_connection(
    network: CPPN, rate: float, inputs: int, *, key: PRNGKeyArray
) -> tuple[CPPN, Int[Array, ""]]:
    """Join two nodes that are not joined, without closing a cycle."""
    whether, which, weight_key = jax.random.split(key, 3)
    nodes, room = network.node_used.shape[0], network.connection_used.shape[0]
    joined = _adjacency(network)
    is_target = network.node_used & (jnp.arange(nodes) >= inputs)
    free = is_target[:, None] & network.node_used[None] & ~joined & ~reached(joined).T
    pair, exists = _choose(free.reshape(-1), key=which)
    row = jnp.sum(network.connection_used)
    happens = jax.random.bernoulli(whether, rate) & exists & (row < room)
    row = jnp.where(happens, row, NONE)
    weight = jax.random.normal(weight_key, (), network.weight.dtype)
    network = _connect(network, row, pair % nodes, pair // nodes, weight)
    return network, row


def add_node(
    network: CPPN, splittable: Bool[Array, "connection"], rate: float, *, key: PRNGKeyArray
) -> tuple[CPPN, Int[Array, ""], Int[Array, ""], Int[Array, ""]]:
    """Split a connection: it is disabled, and a new node takes its place.

    The way in has weight 1 and the way out the old weight, so that with the identity as
    activation nothing would change.
    """
    whether, which, activation_key = jax.random.split(key, 3)
    old, exists = _choose(splittable, key=which)
    node, row = jnp.sum(network.node_used), jnp.sum(network.connection_used)
    happens = jax.random.bernoulli(whether, rate) & exists
    happens = happens & (node < network.node_used.shape[0])
    happens = happens & (row + 1 < network.connection_used.shape[0])
    node_row, split_row = jnp.where(happens, node, NONE), jnp.where(happens, row, NONE)
    activation = jax.random.randint(activation_key, (), 0, len(ACTIVATIONS))
    one = jnp.ones((), network.weight.dtype)
    source, target, weight = network.source[old], network.target[old], network.weight[old]
    innovation = jnp.where(happens, network.innovation[old], NONE)
    network = replace(
        network,
        node_used=_put(network.node_used, node_row, True),
        activation=_put(network.activation, node_row, activation),
        enabled=_put(network.enabled, jnp.where(happens, old, NONE), False),
    )
    network = _connect(network, split_row, source, node, one)
    second = jnp.where(happens, row + 1, NONE)
    return _connect(network, second, node, target, weight), split_row, node_row, innovation


def reached(joined: Bool[Array, "target source"]) -> Bool[Array, "target source"]:
    """Whether a way leads from a source to a target, each node to itself included."""
    nodes = joined.shape[0]
    ways = (joined | jnp.eye(nodes, dtype=bool)).astype(jnp.float32)
    for _ in range(max(1, (nodes - 1).bit_length())):
        ways = jnp.minimum(ways @ ways, 1.0)
    return ways > 0.5


def _adjacency(network: CPPN) -> Bool[Array, "target source"]:
    nodes = network.node_used.shape[0]
    target = jnp.where(network.connection_used, network.target, nodes)
    return jnp.zeros((nodes, nodes), bool).at[target, network.source].set(True, mode="drop")


def _choose(
    allowed: Bool[Array, "item"], *, key: PRNGKeyArray
) -> tuple[Int[Array, ""], Bool[Array, ""]]:
    """One allowed item, each equally likely, and whether there is any."""
    rank = jax.random.randint(key, (), 0, jnp.maximum(1, jnp.sum(allowed)))
    return jnp.argmax(jnp.cumsum(allowed) > rank), jnp.any(allowed)


def _vary(values, used, rates: Rates, *, key: PRNGKeyArray):
    perturb_key, replace_key, step_key, new_key = jax.random.split(key, 4)
    perturbed = jax.random.bernoulli(perturb_key, rates.weight, values.shape)
    replaced = jax.random.bernoulli(replace_key, rates.replace, values.shape)
    step = rates.weight_step * jax.random.normal(step_key, values.shape, values.dtype)
    varied = jnp.where(perturbed, values + step, values)
    varied = jnp.where(replaced, jax.random.normal(new_key, values.shape, values.dtype), varied)
    return jnp.where(used, varied, values)


def _put(values: Array, row: Int[Array, ""], value) -> Array:
    """The values with one replaced, or as they were where `row` is −1."""
    place = jnp.where(row < 0, values.shape[0], row)
    return values.at[place].set(value, mode="drop")


def _connect(network: CPPN, row, source, target, weight) -> CPPN:
    return replace(
        network,
        connection_used=_put(network.connection_used, row, True),
        source=_put(network.source, row, source),
        target=_put(network.target, row, target),
        enabled=_put(network.enabled, row, True),
        weight=_put(network.weight, row, weight),
    )
