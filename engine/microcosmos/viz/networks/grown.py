"""The chain that a CPPN grows, in NumPy: its nodes, lengths and stiffness."""

from dataclasses import replace

import numpy as np

from ...bodies import Body, chain
from ...spec import Grown
from ...spec.encodings import JOINT_TRAITS
from .evaluation import evaluate
from .network import Network

OUTPUTS = 2
"""Outputs of a network that control the body; traits follow, then growth."""


def grown_chain(network: Network, control: Grown, whole: Body) -> Body:
    """Return the chain that a network grows, in double precision.

    It begins with the first node of the `whole` chain, ends before the first node where growth
    is not positive, and has at least `control.min_nodes` nodes. It is straight: inherited rest
    angles change neither its length nor its stiffness.
    """
    *traits, growth = evaluate(network, _inputs(control, whole))[OUTPUTS:]
    ended = np.flatnonzero(growth <= 0)
    count = max(int(ended[0]) if len(ended) else len(growth), control.min_nodes)
    found = chain(count, float(whole.rest_length[0]))
    inherited = dict(zip(control.traits, traits, strict=True))
    values = {
        name: low + (high - low) * 0.5 * (1 + np.tanh(_items(name, inherited[name], found)))
        for name, (low, high) in control.traits.items()
    }
    values.pop("rest_angle", None)
    factor = values.pop("rest_length", 1.0)
    return replace(found, rest_length=found.rest_length * factor, **values)


def _items(name: str, nodes: np.ndarray, body: Body) -> np.ndarray:
    """Return a joint's value at its node, and an edge's as the mean of its ends."""
    return nodes[body.joint_nodes] if name in JOINT_TRAITS else nodes[body.edges].mean(1)


def _inputs(control: Grown, whole: Body) -> np.ndarray:
    """Return the inputs (input, node) with which a network grows: its clocks are 0."""
    nothing = np.zeros(len(whole.arc))
    place = whole.arc if control.position == "unit" else 2 * whole.arc - 1
    return np.stack([place if name == "position" else nothing for name in control.inputs])
