"""Networks from the genes of a creature, and genes of those networks that ours can express."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isinf
from typing import Any

import numpy as np

from ...naming import ACTIVATIONS, decode, encode
from .evaluation import require_agreement
from .graph import depths, order, reached
from .network import Network
from .rewiring import delegated, outputs_first

BOUND = 1e6
"""Our engine keeps values within this; see `genomes.cppn`."""


def of_creature(identity: Mapping[str, Any]) -> Network:
    """The network in a creature's identity; raises `ValueError` where its genes are none.

    A recurrent one is computed as often as the simulation has steps, its inputs held.
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
    """The network of a creature's genes, whose disabled connections are left out.

    Feed-forward, or recurrent over so many `steps` from values of 0.
    """
    nodes, connections = genes["nodes"], genes["connections"]
    on = np.flatnonzero(connections["enabled"]).tolist()
    ids = tuple(nodes["id"])

    def enabled(values: Sequence) -> tuple:
        return tuple(values[place] for place in on)

    return Network(
        inputs=len(inputs),
        outputs=ids[len(inputs) : len(inputs) + len(outputs)],
        keys=ids,
        bias=tuple(decode(nodes["bias"]).tolist()),
        response=(1.0,) * len(ids),
        aggregation=("sum",) * len(ids),
        activation=tuple(nodes["activation"]),
        source=enabled(connections["source"]),
        target=enabled(connections["target"]),
        weight=enabled(decode(connections["weight"]).tolist()),
        marker=enabled(connections["innovation"]),
        rule="always",
        steps=steps,
        bound=BOUND,
        input_names=tuple(inputs),
        output_names=tuple(outputs),
    )


def to_genes(network: Network, *, check: bool = True) -> dict[str, Any]:
    """The genes of a network, checked: they compute the same for random inputs.

    Nodes that never have a value are left out, responses and means become weights; without
    historical markers, innovation numbers follow source and target. Raises `ValueError` with
    the reason where our genes cannot express the network. `check` evaluates both, which a
    population that is converted in every generation need not do again.
    """
    ours = outputs_first(_transformed(_summing(_live_part(_unrolled(network)))))
    genes = _genes(ours)
    if check:
        back = from_genes(genes, [""] * ours.inputs, [""] * len(ours.outputs))
        require_agreement("the imported network", network, back)
    return genes


def _unrolled(network: Network) -> Network:
    """A recurrent network that settles in its steps, as a feed-forward one."""
    if network.steps is None:
        return network
    order(network.keys, network.pairs)
    deepest = max(depths(network.keys, network.pairs).values())
    if deepest > network.steps:
        raise ValueError(f"`steps` must be at least the depth {deepest}, got {network.steps}")
    return replace(network, steps=None)


def _live_part(network: Network) -> Network:
    """Without the nodes that no way leads to from an input, whose messages never count."""
    if network.rule == "always":
        return network
    live = reached(range(network.inputs), network.pairs)
    if dead := sorted(set(network.outputs) - live):
        raise ValueError(
            f"`outputs` must be reached from an input, got {dead}: never live, they are NaN, "
            "where ours would compute a value"
        )
    rows = [row for row, key in enumerate(network.keys) if key in live]
    links = [row for row, key in enumerate(network.source) if key in live]

    def kept(values: tuple, places: list[int]) -> tuple:
        return tuple(values[place] for place in places)

    return replace(
        network,
        keys=kept(network.keys, rows),
        bias=kept(network.bias, rows),
        response=kept(network.response, rows),
        aggregation=kept(network.aggregation, rows),
        activation=kept(network.activation, rows),
        source=kept(network.source, links),
        target=kept(network.target, links),
        weight=kept(network.weight, links),
        marker=None if network.marker is None else kept(network.marker, links),
    )


def _summing(network: Network) -> Network:
    """Responses and means as weights; any aggregation of one message is that message."""
    count = Counter(network.target)
    factor = {}
    for key, name, response in zip(
        network.keys, network.aggregation, network.response, strict=True
    ):
        if name not in ("sum", "mean") and count[key] > 1:
            raise ValueError(
                f"`aggregation` must be sum, mean, or of one message, got {name} of "
                f"{count[key]} at node {key}"
            )
        factor[key] = response / count[key] if name == "mean" and count[key] else response
    weights = zip(network.target, network.weight, strict=True)
    return replace(
        network,
        aggregation=("sum",) * len(network.keys),
        response=(1.0,) * len(network.keys),
        weight=tuple(factor[target] * weight for target, weight in weights),
    )


def _transformed(network: Network) -> Network:
    """The output transform as the outputs' activation, which other nodes do not see."""
    transform = network.output_transform
    if transform is not None:
        for output in network.outputs:
            linear = network.activation[network.keys.index(output)] == "identity"
            if output in network.source or not linear:
                network = delegated(network, output, transform)
        network = replace(
            network,
            output_transform=None,
            activation=tuple(
                transform if key in network.outputs else name
                for key, name in zip(network.keys, network.activation, strict=True)
            ),
        )
    if wrong := sorted(set(network.activation) - set(ACTIVATIONS)):
        raise ValueError(f"`activation` must be among {', '.join(ACTIVATIONS)}, got {wrong}")
    return network


def _genes(network: Network) -> dict[str, Any]:
    links = range(len(network.source))
    if network.marker is None:
        places = sorted(links, key=lambda place: network.pairs[place])
        innovation = list(links)
    else:
        marker = network.marker
        places = sorted(links, key=lambda place: marker[place])
        innovation = [marker[place] for place in places]
    return {
        "nodes": {
            "id": list(network.keys),
            "activation": list(network.activation),
            "bias": _encoded("bias", network.bias),
        },
        "connections": {
            "innovation": innovation,
            "source": [network.source[place] for place in places],
            "target": [network.target[place] for place in places],
            "enabled": [True for _ in places],
            "weight": _encoded("weight", [network.weight[place] for place in places]),
        },
    }


def _encoded(field: str, values: Sequence[float]) -> str:
    with np.errstate(over="ignore"):
        numbers = np.asarray(values, np.float32)
    if np.isinf(numbers).any():
        worst = max((abs(v) for v in values if not isinf(v)), default=float("inf"))
        raise ValueError(f"`{field}` must be within float32, got {worst:g}")
    return encode(numbers)
