"""Networks as the arrays of a TensorNEAT genome and the names that belong to them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from .evaluation import require_agreement
from .functions import ACTIVATIONS, AGGREGATIONS, TO_REGISTER
from .network import LARGEST_KEY, Network
from .reading import CONNECTIONS, NODES, read_tensorneat
from .rewiring import delegated, joined, outputs_first, renumbered

FORMAT = "microcosmos-tensorneat/1"

SMALLEST = 16
"""Rows are this many, or twice as many until they suffice: few shapes, few compilations."""


@dataclass(frozen=True)
class Genome:
    """What TensorNEAT knows of a network, and the names that it does not keep."""

    nodes: np.ndarray
    conns: np.ndarray
    meta: dict[str, Any]


def write_tensorneat(
    network: Network, max_nodes: int | None = None, max_conns: int | None = None
) -> Genome:
    """The genome of a network, checked: read back, it computes the same for random inputs.

    Raises `ValueError` where it does not, or where there is no room.
    """
    written = _written(outputs_first(as_live(network)), max_nodes, max_conns)
    back = read_tensorneat(written.nodes, written.conns, written.meta)
    require_agreement("the exported network", network, back)
    return written


def as_live(network: Network) -> Network:
    """The same function under TensorNEAT's rule, where outputs are linear.

    An output's activation goes to a hidden node before it; a node without sources, which
    would have no value, gets one with weight 0.
    """
    if network.rule == "always":
        fed = set(network.target)
        bare = [k for k in network.keys if k >= network.inputs and k not in fed]
        network = replace(joined(network, 0, bare, 0.0), rule="live", marker=None, bound=inf)
    for output in network.outputs:
        if network.activation[network.keys.index(output)] != "identity":
            network = delegated(network, output, "identity")
    if max(network.keys) < LARGEST_KEY - len(network.outputs):
        return network
    rank = {key: place for place, key in enumerate(sorted(network.keys))}
    return renumbered(network, rank.__getitem__)


def room(needed: int) -> int:
    """The smallest of 16, 32, 64 … that holds as many rows."""
    size = SMALLEST
    while size < needed:
        size *= 2
    return size


def _written(network: Network, max_nodes: int | None, max_conns: int | None) -> Genome:
    has_response = any(response != 1 for response in network.response)
    node_class = "DefaultNode" if has_response else "BiasNode"
    marked = network.marker is not None and max(network.marker, default=0) < LARGEST_KEY
    conn_class = "OriginConn" if marked else "DefaultConn"
    activations = [name for name in ACTIVATIONS if name in network.activation]
    aggregations = [name for name in AGGREGATIONS if name in network.aggregation]
    columns = {
        "bias": network.bias,
        "response": network.response,
        "aggregation": [aggregations.index(name) for name in network.aggregation],
        "activation": [activations.index(name) for name in network.activation],
        "marker": network.marker,
        "weight": network.weight,
    }
    nodes = [network.keys, *(columns[name] for name in NODES[node_class])]
    ends = [network.source, network.target]
    conns = ends + [columns[name] for name in CONNECTIONS[conn_class]]
    size = len(network.keys) if max_nodes is None else max_nodes
    length = len(network.source) if max_conns is None else max_conns
    genome = (
        _padded("max_nodes", nodes, room(size) if max_nodes is None else size),
        _padded("max_conns", conns, room(length) if max_conns is None else length),
    )
    meta = {"node_class": node_class, "conn_class": conn_class}
    meta |= {"activation_names": activations, "aggregation_names": aggregations}
    return Genome(*genome, _described(network) | meta)


def _described(network: Network) -> dict[str, Any]:
    recurrent = network.steps is not None
    used = {*network.activation, network.output_transform}
    return {
        "format": FORMAT,
        "genome_class": "RecurrentGenome" if recurrent else "DefaultGenome",
        "network_type": "recurrent" if recurrent else "feedforward",
        "activate_time": network.steps,
        "num_inputs": network.inputs,
        "num_outputs": len(network.outputs),
        "input_keys": list(range(network.inputs)),
        "output_keys": list(network.outputs),
        "input_names": list(network.input_names),
        "output_names": list(network.output_names),
        "input_transform": None,
        "output_transform": network.output_transform,
        "register": [name for name in TO_REGISTER if name in used],
    }


def _padded(field: str, columns: Sequence, rows: int) -> np.ndarray:
    needed = len(columns[0])
    if needed > rows:
        raise ValueError(f"`{field}` must be at least {needed}, got {rows}")
    table = np.full((rows, len(columns)), np.nan, np.float32)
    table[:needed] = np.array(columns, float).T.reshape(needed, len(columns))
    return table
