"""Conversion of a creature's genes to networks, and of networks to genes where possible."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isinf
from typing import Any

import numpy as np

from ..naming import ACTIVATIONS, decode, encode
from .functions import BOUND, BOUNDED
from .network import (
    Link,
    Network,
    Node,
    delegated,
    depths,
    order,
    outputs_first,
    reached,
    require_agreement,
)


def of_creature(identity: Mapping[str, Any]) -> Network:
    """Return the network in a creature's identity. Raises `ValueError` if it has none.

    A recurrent one runs for the steps of the simulation with constant inputs.
    """
    genome = identity["genome"]
    if "nodes" not in genome:
        raise ValueError(f"`genome.encoding` must hold a network, got {genome['encoding']!r}")
    recurrent = genome["control"].get("recurrent", False)
    steps = identity["task"]["steps"] if recurrent else None
    return from_genes(genome, genome["inputs"], genome["outputs"], steps)


def from_genes(
    genes: Mapping[str, Any],
    inputs: Sequence[str],
    outputs: Sequence[str],
    steps: int | None = None,
) -> Network:
    """Return the network of a creature's genes without disabled connections.

    With `steps` it is recurrent, and starts from values of 0.
    """
    nodes, connections = genes["nodes"], genes["connections"]
    biases, weights = decode(nodes["bias"]).tolist(), decode(connections["weight"]).tolist()
    names = zip(nodes["id"], biases, nodes["activation"], strict=True)
    columns = (connections[name] for name in ("source", "target", "innovation", "enabled"))
    rows = zip(weights, *columns, strict=True)
    first = len(inputs)
    return Network(
        inputs=first,
        outputs=tuple(nodes["id"][first : first + len(outputs)]),
        nodes=tuple(Node(key, bias, activation=name) for key, bias, name in names),
        links=tuple(Link(a, b, weight, number) for weight, a, b, number, on in rows if on),
        rule="always",
        steps=steps,
        bound=BOUND,
        input_names=tuple(inputs),
        output_names=tuple(outputs),
    )


def to_genes(network: Network, *, check: bool = True) -> dict[str, Any]:
    """Return the genes of a network; `check` compares their outputs on random inputs.

    Nodes that never have a value are left out, responses and means become weights. Without
    historical markers, innovation numbers follow source and target. Raises `ValueError` with
    the reason if our genes cannot express the network.
    """
    ours = outputs_first(_transformed(_summing(_live_part(_unrolled(_plain(network))))))
    genes = _genes(ours)
    if check:
        back = from_genes(genes, [""] * ours.inputs, [""] * len(ours.outputs))
        require_agreement("the imported network", network, back)
    return genes


def _plain(network: Network) -> Network:
    """Name activations that keep the bound as our genes, all of which keep it, name them."""
    plain = {bounded: name for name, bounded in BOUNDED.items()}
    nodes = [
        replace(n, activation=plain.get(n.activation, n.activation)) for n in network.nodes
    ]
    return replace(network, nodes=tuple(nodes))


def _unrolled(network: Network) -> Network:
    """Return a recurrent network that settles in its steps as a feed-forward one."""
    if network.steps is None:
        return network
    order(network.keys, network.pairs)
    deepest = max(depths(network.keys, network.pairs).values())
    if deepest > network.steps:
        raise ValueError(f"`steps` must be at least the depth {deepest}, got {network.steps}")
    return replace(network, steps=None)


def _live_part(network: Network) -> Network:
    """Remove the nodes that no input reaches; their messages never count."""
    if network.rule == "always":
        return network
    live = reached(range(network.inputs), network.pairs)
    if dead := sorted(set(network.outputs) - live):
        raise ValueError(
            f"`outputs` must be reached from an input, got {dead}: never live, they are NaN, "
            "where ours would compute a value"
        )
    return replace(
        network,
        nodes=tuple(node for node in network.nodes if node.key in live),
        links=tuple(link for link in network.links if link.source in live),
    )


def _summing(network: Network) -> Network:
    """Express responses and means as weights; an aggregation of one message is that message."""
    factor = {}
    for node in network.nodes:
        count, name = len(network.incoming[node.key]), node.aggregation
        if name not in ("sum", "mean") and count > 1:
            raise ValueError(
                f"`aggregation` must be sum, mean, or of one message, got {name} of "
                f"{count} at node {node.key}"
            )
        factor[node.key] = node.response / count if name == "mean" and count else node.response
    return replace(
        network,
        nodes=tuple(replace(node, aggregation="sum", response=1.0) for node in network.nodes),
        links=tuple(
            replace(link, weight=factor[link.target] * link.weight) for link in network.links
        ),
    )


def _transformed(network: Network) -> Network:
    """Return the output transform as the outputs' activation, which other nodes do not see."""
    transform = network.output_transform
    if transform is not None:
        for output in network.outputs:
            read = any(link.source == output for link in network.links)
            if read or network.node[output].activation != "identity":
                network = delegated(network, output, transform)
        network = replace(
            network,
            output_transform=None,
            nodes=tuple(
                replace(node, activation=transform) if node.key in network.outputs else node
                for node in network.nodes
            ),
        )
    if wrong := sorted({node.activation for node in network.nodes} - set(ACTIVATIONS)):
        raise ValueError(f"`activation` must be among {', '.join(ACTIVATIONS)}, got {wrong}")
    return network


def _genes(network: Network) -> dict[str, Any]:
    def place(link: Link) -> tuple[int, ...]:
        return (link.marker or 0,) if network.marked else (link.source, link.target)

    links = sorted(network.links, key=place)
    return {
        "nodes": {
            "id": list(network.keys),
            "activation": [node.activation for node in network.nodes],
            "bias": _encoded("bias", [node.bias for node in network.nodes]),
        },
        "connections": {
            "innovation": [x.marker if network.marked else i for i, x in enumerate(links)],
            "source": [link.source for link in links],
            "target": [link.target for link in links],
            "enabled": [True for _ in links],
            "weight": _encoded("weight", [link.weight for link in links]),
        },
    }


def _encoded(field: str, values: Sequence[float]) -> str:
    # Values beyond float32 become infinite, which is refused below.
    with np.errstate(over="ignore"):
        numbers = np.asarray(values, np.float32)
    if np.isinf(numbers).any():
        worst = max((abs(v) for v in values if not isinf(v)), default=float("inf"))
        raise ValueError(f"`{field}` must be within float32, got {worst:g}")
    return encode(numbers)
