"""Networks as the arrays of a TensorNEAT genome and the names that belong to them."""

from dataclasses import dataclass, replace
from math import inf, isinf
from typing import Any

import numpy as np

from .evaluation import agree, evaluate, probes, require_agreement
from .functions import ACTIVATIONS, AGGREGATIONS, BOUNDED, TO_REGISTER
from .network import LARGEST_KEY, Link, Network, delegated, outputs_first, renumbered
from .reading import CONNECTIONS, NODES, read_tensorneat

FORMAT = "microcosmos-tensorneat/1"

SMALLEST = 16
"""Least number of rows, doubled until they suffice: few shapes need few compilations."""


@dataclass(frozen=True)
class Genome:
    """The arrays of a network for TensorNEAT, and the names that it does not keep."""

    nodes: np.ndarray
    conns: np.ndarray
    meta: dict[str, Any]


def write_tensorneat(
    network: Network, max_nodes: int | None = None, max_conns: int | None = None
) -> Genome:
    """Return the genome of a network, checked: read back, it computes the same.

    Raises `ValueError` if it does not, or if there is no room.
    """
    written = _written(outputs_first(as_live(network)), max_nodes, max_conns)
    back = read_tensorneat(written.nodes, written.conns, written.meta)
    require_agreement("the exported network", network, back)
    return written


def as_live(network: Network) -> Network:
    """Return the same function under TensorNEAT's rule, where outputs are linear.

    An output's activation goes to a hidden node before it; a node without sources, which
    would have no value, gets one with weight 0.
    """
    network = _unbounded(network)
    if network.rule == "always":
        links = [replace(link, marker=None) for link in network.links]
        computed = network.keys[network.inputs :]
        links += [Link(0, key, 0.0) for key in computed if not network.incoming[key]]
        network = replace(network, rule="live", links=tuple(links))
    for output in network.outputs:
        if network.node[output].activation != "identity":
            network = delegated(network, output, "identity")
    if max(network.keys) < LARGEST_KEY - len(network.outputs):
        return network
    rank = {key: place for place, key in enumerate(sorted(network.keys))}
    return renumbered(network, rank.__getitem__)


def _unbounded(network: Network) -> Network:
    """Return the same function without a bound of its own.

    Where random inputs pass the bound, activations keep it.
    """
    if isinf(network.bound):
        return network
    free, points = replace(network, bound=inf), probes(network.inputs)
    if agree(evaluate(network, points), evaluate(free, points)):
        return free
    kept = [
        node
        if node.key < network.inputs
        else replace(node, activation=BOUNDED.get(node.activation, node.activation))
        for node in network.nodes
    ]
    return replace(free, nodes=tuple(kept))


def room(needed: int) -> int:
    """Return the smallest of 16, 32, 64 … that holds as many rows."""
    return max(SMALLEST, 1 << (needed - 1).bit_length())


def _written(network: Network, max_nodes: int | None, max_conns: int | None) -> Genome:
    has_response = any(node.response != 1 for node in network.nodes)
    node_class = "DefaultNode" if has_response else "BiasNode"
    marked = network.marked and max(x.marker or 0 for x in network.links) < LARGEST_KEY
    conn_class = "OriginConn" if marked else "DefaultConn"
    # All of them always, so that one compiled program evaluates all networks.
    activations = list(ACTIVATIONS)
    used = {node.aggregation for node in network.nodes}
    aggregations = [name for name in AGGREGATIONS if name in used]
    index = {"aggregation": aggregations.index, "activation": activations.index}
    nodes = [
        [node.key, *(index.get(x, float)(getattr(node, x)) for x in NODES[node_class])]
        for node in network.nodes
    ]
    columns = ("source", "target", *CONNECTIONS[conn_class])
    conns = [[getattr(link, name) for name in columns] for link in network.links]
    size = room(len(nodes)) if max_nodes is None else max_nodes
    length = room(len(conns)) if max_conns is None else max_conns
    meta = {"node_class": node_class, "conn_class": conn_class}
    meta |= {"activation_names": activations, "aggregation_names": aggregations}
    return Genome(
        _padded("max_nodes", nodes, 1 + len(NODES[node_class]), size),
        _padded("max_conns", conns, len(columns), length),
        _described(network) | meta,
    )


def _described(network: Network) -> dict[str, Any]:
    recurrent = network.steps is not None
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
        "register": list(TO_REGISTER),
    }


def _padded(field: str, given: list[list[Any]], columns: int, rows: int) -> np.ndarray:
    if len(given) > rows:
        raise ValueError(f"`{field}` must be at least {len(given)}, got {rows}")
    table = np.full((rows, columns), np.nan, np.float32)
    table[: len(given)] = np.array(given, float).reshape(len(given), columns)
    return table
