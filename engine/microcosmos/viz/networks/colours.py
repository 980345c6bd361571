"""How drawn networks look, and what is said of them."""

from .network import Network

ACTIVATION = {
    "identity": "#dfe3e8",
    "sigmoid": "#b9d7f5",
    "tanh": "#9fe0da",
    "relu": "#f9d59b",
    "sin": "#d5c4f4",
    "cos": "#f3c3e4",
    "gaussian": "#c8e6a8",
    "abs": "#f6bfb4",
    "square": "#f2e59a",
}
"""Light, so that dark letters can be read on them in either scheme."""

OTHER, INPUT = "#cfd8dc", "#ffffff"
POSITIVE, NEGATIVE = "#3a86c8", "#d9643a"


def fill(network: Network, key: int) -> str:
    """The colour of a node."""
    if key < network.inputs:
        return INPUT
    return ACTIVATION.get(activation(network, key), OTHER)


def activation(network: Network, key: int) -> str:
    """The activation of a node, the transform of its own where it is an output's."""
    name = network.activation[network.keys.index(key)]
    transform = network.output_transform
    return transform if key in network.outputs and transform and name == "identity" else name


def label(network: Network, key: int) -> str:
    """What is written on a node."""
    if key < network.inputs:
        return network.names[key]
    name = activation(network, key)
    aggregation = network.aggregation[network.keys.index(key)]
    return name if aggregation == "sum" else f"{aggregation} {name}"


def value_text(network: Network, key: int) -> str:
    """What a node is, for whoever points at it."""
    row = network.keys.index(key)
    if key < network.inputs:
        return network.names[key]
    name = network.names.get(key, f"node {key}")
    return f"{name}: {label(network, key)}, bias {network.bias[row]:.4g}"


def thickness(network: Network, weight: float, least: float, most: float) -> float:
    """Of a connection, in proportion to its weight."""
    largest = max(map(abs, network.weight))
    return least + (most - least) * (abs(weight) / largest if largest else 0.0)


def described(network: Network) -> str:
    """A network in one sentence."""
    kind = f"recurrent network ({network.steps} steps)" if network.steps else "network"
    inputs, outputs = _count(network.inputs, "input"), _count(len(network.outputs), "output")
    hidden = _count(len(network.hidden), "hidden node")
    return f"A {kind} with {inputs}, {outputs}, {hidden} and " + _count(
        len(network.source), "connection"
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")
