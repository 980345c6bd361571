"""Compositional pattern-producing networks as fixed-size masked arrays of NEAT genes.

CPPN: Stanley, Genet. Program. Evolvable Mach. 8, 131 (2007); genes: Stanley and
Miikkulainen, Evol. Comput. 10, 99 (2002). Used rows come first, in the order in which the
genes arose, so that their numbers increase along the rows.
"""

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from ..portable import cosine, sine

Points = Float[Array, "_ point"]

BOUND = 1e6
"""Limit of values, so that a chain of squares cannot overflow into NaN."""

# The order is that of `naming.ACTIVATIONS`, which a test compares.
ACTIVATIONS = {
    "identity": lambda z: z,
    "sigmoid": jax.nn.sigmoid,
    "tanh": jnp.tanh,
    "relu": lambda z: jnp.maximum(z, 0),
    "sin": sine,
    "cos": cosine,
    "gaussian": lambda z: jnp.exp(-z * z),
    "abs": jnp.abs,
    "square": lambda z: z * z,
}


class CPPN(eqx.Module):
    """A network; rows of nodes are inputs, outputs, then hidden nodes."""

    node_used: Bool[Array, "*batch node"]
    node_id: Int[Array, "*batch node"]
    activation: Int[Array, "*batch node"]
    bias: Float[Array, "*batch node"]
    connection_used: Bool[Array, "*batch connection"]
    innovation: Int[Array, "*batch connection"]
    source: Int[Array, "*batch connection"]
    """Row of a connection's source node."""
    target: Int[Array, "*batch connection"]
    enabled: Bool[Array, "*batch connection"]
    weight: Float[Array, "*batch connection"]


def minimal(
    key: PRNGKeyArray,
    inputs: int,
    outputs: int,
    max_nodes: int,
    max_connections: int,
    palette: tuple[int, ...] = tuple(range(len(ACTIVATIONS))),
) -> CPPN:
    """Connect every input to every output, with normal weights and biases of deviation 1.

    Activations of outputs are drawn uniformly from the palette.
    """
    weight_key, bias_key, activation_key = jax.random.split(key, 3)
    node, row = jnp.arange(max_nodes), jnp.arange(max_connections)
    node_used, row_used = node < inputs + outputs, row < inputs * outputs
    is_output = node_used & (node >= inputs)
    drawn = jax.random.randint(activation_key, (max_nodes,), 0, len(palette))
    drawn = jnp.asarray(np.asarray(palette, np.int32))[drawn]
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


def depths(network: CPPN) -> Int[Array, "node"]:
    """Return the longest path to each node over all connections, enabled or not."""
    nodes = network.node_used.shape[0]
    # Unused rows point behind the last node, where scattering drops them.
    target = jnp.where(network.connection_used, network.target, nodes)

    def relax(_, depth):
        return depth.at[target].max(depth[network.source] + 1, mode="drop")

    return jax.lax.fori_loop(0, nodes, relax, jnp.zeros(nodes, jnp.int32))


def matrix(network: CPPN, dtype: Any) -> Float[Array, "target source"]:
    """Return the weights of enabled connections, 0 elsewhere."""
    nodes = network.node_used.shape[0]
    live = network.connection_used & network.enabled
    target = jnp.where(live, network.target, nodes)
    weights = jnp.zeros((nodes, nodes), dtype)
    return weights.at[target, network.source].set(network.weight.astype(dtype), mode="drop")


def evaluate(network: CPPN, inputs: Points, outputs: int) -> Points:
    """Return the values of output nodes (output, point) for inputs (input, point)."""
    nodes, given = network.node_used.shape[0], inputs.shape[0]
    weights = matrix(network, inputs.dtype)
    # Sources come before targets. Disabled connections count too: enabling one keeps the order.
    order = jnp.argsort(depths(network), stable=True)
    functions = list(ACTIVATIONS.values())
    # Inputs and unused rows keep their values.
    computed = network.node_used & (np.arange(nodes) >= given)

    def visit(values, node):
        def value():
            # A written-out sum: a library may split a matrix product differently elsewhere.
            z = network.bias[node] + jnp.sum(weights[node][:, None] * values, 0)
            activated = jax.lax.switch(network.activation[node], functions, z)
            return jnp.clip(activated, -BOUND, BOUND)

        # Branch on one row only: a branch over all values would copy them.
        return values.at[node].set(
            jax.lax.cond(computed[node], value, lambda: values[node])
        ), None

    values = jnp.zeros((nodes, inputs.shape[1]), inputs.dtype).at[:given].set(inputs)
    values, _ = jax.lax.scan(visit, values, order)
    return values[given : given + outputs]
