"""Conversion of a population of TensorNEAT's genomes to our networks, without a loop.

Each row equals the result of `viz.networks.to_genes`; a test compares them.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from ..genomes import ACTIVATIONS, CPPN, empty

Nodes = Float[np.ndarray, "genome node 4"]
"""Key, bias, aggregation (a sum always), activation; NaN where unused."""

Links = Float[np.ndarray, "genome link 3"]
"""Source, target, weight; NaN where unused."""

Rows = Int[np.ndarray, "genome row"]
Marks = Bool[np.ndarray, "genome row"]


def cppns(
    nodes: Nodes, links: Links, activations: Sequence[str], inputs: int, outputs: int
) -> tuple[CPPN, Bool[np.ndarray, "genome"]]:
    """Convert feed-forward genomes to networks; also return which of them compute every output.

    The others, whose outputs are NaN, become networks of inputs and outputs alone.
    """
    source, target = (_rows(nodes, links[..., end]) for end in (0, 1))
    live = _live(nodes, links, source, target, inputs)
    computes = np.all(live[:, inputs : inputs + outputs], axis=1)
    fixed = np.arange(nodes.shape[1]) < inputs + outputs
    kept = (live & computes[:, None]) | fixed[None]
    linked = ~np.isnan(links[..., 0]) & np.take_along_axis(live, source, 1) & computes[:, None]
    network = empty(nodes.shape[1], links.shape[1], (len(nodes),))
    place = _put_nodes(network, nodes, kept, _activation(nodes, activations, fixed))
    ends = (np.take_along_axis(place, end, 1) for end in (source, target))
    _put_links(network, links, linked, *ends)
    silent = ~computes[:, None] | (np.arange(nodes.shape[1]) < inputs)[None]
    network.bias[silent] = 0
    return network, computes


def _put_nodes(network: CPPN, nodes: Nodes, kept: Marks, activation: Rows) -> Rows:
    """Write the kept nodes in the order of their keys; the new rows of the old ones."""
    order = np.argsort(np.where(kept, nodes[..., 0], np.inf), axis=1, kind="stable")

    def moved(values: np.ndarray) -> np.ndarray:
        return np.take_along_axis(np.where(kept, values, 0), order, 1)

    network.node_used[:] = np.take_along_axis(kept, order, 1)
    network.node_id[:] = moved(nodes[..., 0])
    network.activation[:] = moved(activation)
    network.bias[:] = moved(nodes[..., 1])
    return np.argsort(order, axis=1)


def _put_links(network: CPPN, links: Links, linked: Marks, source: Rows, target: Rows) -> None:
    keys = [np.where(linked, links[..., end], np.inf) for end in (1, 0)]
    order = np.lexsort(keys, axis=1)
    given = np.take_along_axis(linked, order, 1)
    network.connection_used[:] = given
    network.enabled[:] = given
    network.innovation[:] = np.where(given, np.arange(links.shape[1])[None], 0)
    for column, values in (
        (network.source, source),
        (network.target, target),
        (network.weight, links[..., 2]),
    ):
        column[:] = np.where(given, np.take_along_axis(values, order, 1), 0)


def _rows(nodes: Nodes, keys: Float[np.ndarray, "genome link"]) -> Rows:
    """Return the rows of the nodes with these keys; 0 for an unused link."""
    return np.argmax(nodes[:, None, :, 0] == keys[:, :, None], axis=2)


def _live(
    nodes: Nodes, links: Links, source: Rows, target: Rows, inputs: int
) -> Bool[np.ndarray, "genome node"]:
    used = ~np.isnan(links[..., 0])
    live = np.zeros(nodes.shape[:2], bool)
    live[:, :inputs] = True
    genome = np.arange(len(nodes))[:, None]
    while True:
        grown = live.copy()
        np.logical_or.at(grown, (genome, target), used & np.take_along_axis(live, source, 1))
        if (grown == live).all():
            return live
        live = grown


def _activation(nodes: Nodes, names: Sequence[str], linear: Bool[np.ndarray, "node"]) -> Rows:
    """Convert indices of TensorNEAT's list, whose −1 is the identity, to our numbers."""
    known = list(ACTIVATIONS)
    identity = known.index("identity")
    number = np.array([*map(known.index, names), identity])
    places = np.nan_to_num(nodes[..., 3]).astype(int)
    return np.where(linear[None], identity, number[places])
