"""Genes as they stand in a creature file, from and to arrays."""

from collections.abc import Mapping
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from ..naming import ACTIVATIONS, decode, encode
from .cppn import CPPN

T = TypeVar("T")


def to_genes(network: CPPN) -> dict[str, Any]:
    """The used genes of one network of NumPy arrays."""
    n, c = int(network.node_used.sum()), int(network.connection_used.sum())
    ids = network.node_id
    return {
        "nodes": {
            "id": ids[:n].tolist(),
            "activation": [ACTIVATIONS[a] for a in network.activation[:n].tolist()],
            "bias": encode(np.asarray(network.bias[:n])),
        },
        "connections": {
            "innovation": network.innovation[:c].tolist(),
            "source": ids[network.source[:c]].tolist(),
            "target": ids[network.target[:c]].tolist(),
            "enabled": network.enabled[:c].tolist(),
            "weight": encode(np.asarray(network.weight[:c])),
        },
    }


def from_genes(genes: Mapping[str, Any], max_nodes: int, max_connections: int) -> CPPN:
    """The network of a parsed creature file, with room for more genes."""
    nodes, connections = genes["nodes"], genes["connections"]
    row = {number: row for row, number in enumerate(nodes["id"])}
    network = empty(max_nodes, max_connections)
    n, c = len(row), len(connections["innovation"])
    network.node_used[:n] = True
    network.node_id[:n] = nodes["id"]
    network.activation[:n] = [ACTIVATIONS.index(a) for a in nodes["activation"]]
    network.bias[:n] = decode(nodes["bias"])
    network.connection_used[:c] = True
    network.innovation[:c] = connections["innovation"]
    network.source[:c] = [row[number] for number in connections["source"]]
    network.target[:c] = [row[number] for number in connections["target"]]
    network.enabled[:c] = connections["enabled"]
    network.weight[:c] = decode(connections["weight"])
    return network


def empty(max_nodes: int, max_connections: int, batch: tuple[int, ...] = ()) -> CPPN:
    """NumPy arrays without any gene, to be written to."""
    node, connection = (*batch, max_nodes), (*batch, max_connections)
    network = CPPN(
        node_used=jnp.zeros(node, bool),
        node_id=jnp.zeros(node, jnp.int32),
        activation=jnp.zeros(node, jnp.int32),
        bias=jnp.zeros(node, jnp.float32),
        connection_used=jnp.zeros(connection, bool),
        innovation=jnp.zeros(connection, jnp.int32),
        source=jnp.zeros(connection, jnp.int32),
        target=jnp.zeros(connection, jnp.int32),
        enabled=jnp.zeros(connection, bool),
        weight=jnp.zeros(connection, jnp.float32),
    )
    return jax.tree.map(np.array, network)


def take(genotypes: T, index: int) -> T:
    """One genotype of a batch, as NumPy arrays."""
    return jax.tree.map(lambda x: np.asarray(x)[index], genotypes)
