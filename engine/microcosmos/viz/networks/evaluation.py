"""Evaluation of networks in double precision, and comparison of two of them."""

import numpy as np

from .functions import ACTIVATIONS, AGGREGATIONS
from .graph import order
from .network import Network, Node

TOLERANCE = 1e-6
"""Largest difference of equal networks, relative to max(1, |value|)."""


def evaluate(network: Network, inputs: np.ndarray) -> np.ndarray:
    """Return outputs (output, point) for inputs (input, point), NaN where there is no value."""
    inputs = np.asarray(inputs, float)
    if inputs.ndim != 2 or len(inputs) != network.inputs:
        raise ValueError(f"`inputs` must be ({network.inputs}, points), got {inputs.shape}")
    start = np.nan if network.rule == "live" else 0.0
    values = {key: np.full(inputs.shape[1], start) for key in network.keys}
    values.update(enumerate(inputs))
    keys = network.keys if network.steps else order(network.keys, network.pairs)
    nodes = [network.node[key] for key in keys if key >= network.inputs]
    with np.errstate(all="ignore"):
        if network.steps is None:
            for node in nodes:
                values[node.key] = _value(network, node, values)
        for _ in range(network.steps or 0):
            values |= {node.key: _value(network, node, values) for node in nodes}
        outputs = np.stack([values[key] for key in network.outputs])
        return ACTIVATIONS[network.output_transform or "identity"](outputs)


def probes(inputs: int) -> np.ndarray:
    """Return inputs (input, point) for comparisons: all 0, all 1, the rest normal."""
    drawn = np.random.default_rng(0).normal(size=(inputs, 256))
    drawn[:, 0], drawn[:, 1] = 0.0, 1.0
    return drawn


def agree(one: np.ndarray, other: np.ndarray, tolerance: float = TOLERANCE) -> bool:
    """Return whether values agree within the tolerance, NaN and infinity at the same places."""
    with np.errstate(invalid="ignore"):
        close = np.abs(one - other) <= tolerance * np.maximum(1, np.abs(one))
    same = (one == other) | (np.isnan(one) & np.isnan(other))
    return bool(np.all(same | (close & np.isfinite(one))))


def require_agreement(what: str, one: Network, other: Network) -> None:
    """Raise `ValueError` unless both networks compute the same for 256 random inputs."""
    inputs = probes(one.inputs)
    before, after = evaluate(one, inputs), evaluate(other, inputs)
    if not agree(before, after):
        with np.errstate(all="ignore"):
            worst = np.nanmax(np.abs(before - after) / np.maximum(1, np.abs(before)))
        bound = min(one.bound, other.bound)
        reason = f" (only one of the two keeps values within ±{bound:g})"
        raise ValueError(
            f"{what} must compute the same within {TOLERANCE:g} of max(1, |value|), "
            f"got a difference of {worst:.3g}{reason * (one.bound != other.bound)}"
        )


def _value(network: Network, node: Node, values: dict[int, np.ndarray]) -> np.ndarray:
    """Return a node's new value at every point, the old one if no message is live."""
    old, links = values[node.key], network.incoming[node.key]
    if not links:
        return _emitted(network, node, np.zeros_like(old)) if network.rule == "always" else old
    sources = np.stack([values[link.source] for link in links])
    weights = np.array([link.weight for link in links])[:, None]
    live = ~np.isnan(sources) if network.rule == "live" else np.ones(sources.shape, bool)
    new = _emitted(network, node, AGGREGATIONS[node.aggregation](weights * sources, live))
    return np.where(live.any(0), new, old)


def _emitted(network: Network, node: Node, gathered: np.ndarray) -> np.ndarray:
    z = node.bias + node.response * gathered
    return np.clip(ACTIVATIONS[node.activation](z), -network.bound, network.bound)
