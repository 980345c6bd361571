"""The same network with other nodes: keys renumbered, an output's part given to another."""

from collections.abc import Callable
from dataclasses import replace

from .network import Network


def renumbered(network: Network, key: Callable[[int], int]) -> Network:
    """The network with every key exchanged, nodes in the order of the new ones."""
    rows = sorted(range(len(network.keys)), key=lambda row: key(network.keys[row]))

    def column(values: tuple) -> tuple:
        return tuple(values[row] for row in rows)

    return replace(
        network,
        outputs=tuple(map(key, network.outputs)),
        keys=tuple(map(key, column(network.keys))),
        bias=column(network.bias),
        response=column(network.response),
        aggregation=column(network.aggregation),
        activation=column(network.activation),
        source=tuple(map(key, network.source)),
        target=tuple(map(key, network.target)),
    )


def outputs_first(network: Network) -> Network:
    """Outputs follow the inputs, hidden nodes the outputs; a key has one new key always."""
    fixed = {key: network.inputs + place for place, key in enumerate(network.outputs)}

    def key(old: int) -> int:
        if old < network.inputs:
            return old
        return fixed.get(old, old + sum(output > old for output in network.outputs))

    return renumbered(network, key)


def delegated(network: Network, output: int, activation: str) -> Network:
    """A new hidden node takes an output's place; the output reads it and has the activation."""
    new = max(network.keys) + 1
    row = network.keys.index(output)

    def instead(keys: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(new if key == output else key for key in keys)

    def column(values: tuple, kept) -> tuple:
        return (*values[:row], kept, *values[row + 1 :], values[row])

    return replace(
        network,
        keys=(*network.keys, new),
        bias=column(network.bias, 0.0),
        response=column(network.response, 1.0),
        aggregation=column(network.aggregation, "sum"),
        activation=column(network.activation, activation),
        source=(*instead(network.source), new),
        target=(*instead(network.target), output),
        weight=(*network.weight, 1.0),
        marker=None,
    )


def joined(network: Network, source: int, targets: list[int], weight: float) -> Network:
    """The network with one more connection to each target."""
    return replace(
        network,
        source=network.source + (source,) * len(targets),
        target=network.target + tuple(targets),
        weight=network.weight + (weight,) * len(targets),
        marker=network.marker if not targets else None,
    )
