"""Colours and labels of drawn networks."""

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
"""Light colours, on which dark letters are readable in either scheme."""

OTHER, INPUT = "#cfd8dc", "#ffffff"
POSITIVE, NEGATIVE = "#3a86c8", "#d9643a"


def fill(network: Network, key: int) -> str:
    if key < network.inputs:
        return INPUT
    return ACTIVATION.get(activation(network, key), OTHER)


def activation(network: Network, key: int) -> str:
    """The activation of a node; an output also has the transform."""
    name = network.node[key].activation
    transform = network.output_transform
    return transform if key in network.outputs and transform and name == "identity" else name


def label(network: Network, key: int) -> str:
    if key < network.inputs:
        return network.names[key]
    name = activation(network, key)
    aggregation = network.node[key].aggregation
    return name if aggregation == "sum" else f"{aggregation} {name}"


def value_text(network: Network, key: int) -> str:
    """The description of a node, for a tooltip."""
    if key < network.inputs:
        return network.names[key]
    name = network.names.get(key, f"node {key}")
    return f"{name}: {label(network, key)}, bias {network.node[key].bias:.4g}"


def thickness(network: Network, weight: float, least: float, most: float) -> float:
    """The width of a connection, in proportion to its weight."""
    largest = max(abs(link.weight) for link in network.links)
    return least + (most - least) * (abs(weight) / largest if largest else 0.0)


def described(network: Network) -> str:
    """The network in one sentence."""
    kind = f"recurrent network ({network.steps} steps)" if network.steps else "network"
    inputs, outputs = _count(network.inputs, "input"), _count(len(network.outputs), "output")
    hidden = _count(len(network.hidden), "hidden node")
    return f"A {kind} with {inputs}, {outputs}, {hidden} and " + _count(
        len(network.links), "connection"
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")
