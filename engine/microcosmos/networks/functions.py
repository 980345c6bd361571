"""Activations and aggregations of networks by name, on NumPy arrays.

Names are TensorNEAT's; the formulas are in `docs/networks.md`. `code` writes the source of
these functions into standalone modules, so each needs NumPy only.
"""

from collections.abc import Callable
from functools import reduce

import numpy as np


def identity(z):
    return z


# Below −700 the exponential would overflow, with a warning.
def sigmoid(z):
    return 1 / (1 + np.exp(-np.maximum(z, -700.0)))


def relu(z):
    return np.maximum(z, 0.0)


def gaussian(z):
    return np.exp(-z * z)


def scaled_sigmoid(z):
    return 3 / (1 + np.exp(-np.maximum(z, -700.0)))


def scaled_tanh(z):
    return 3 * np.tanh(z)


# TensorNEAT's constants: the slope here, and 10⁻⁷ below.
def lelu(z):
    return np.where(z > 0, z, 0.005 * z)


def inv(z):
    return 1 / np.where(z > 0, np.maximum(z, 1e-7), np.minimum(z, -1e-7))


def log(z):
    return np.log(np.maximum(z, 1e-7))


# Our functions whose values exceed 1, clipped as our engine does. Standalone modules lack
# `BOUND`.
def bounded_identity(z):
    return np.clip(z, -1e6, 1e6)


def bounded_relu(z):
    return np.clip(z, 0.0, 1e6)


def bounded_abs(z):
    return np.minimum(np.abs(z), 1e6)


def bounded_square(z):
    return np.minimum(np.square(z), 1e6)


BOUND = 1e6
"""Largest value of a node in our engine; see `genomes.cppn`."""

ACTIVATIONS: dict[str, Callable] = {
    "identity": identity,
    "sigmoid": sigmoid,
    "tanh": np.tanh,
    "relu": relu,
    "sin": np.sin,
    "cos": np.cos,
    "gaussian": gaussian,
    "abs": np.abs,
    "square": np.square,
    "scaled_sigmoid": scaled_sigmoid,
    "scaled_tanh": scaled_tanh,
    "lelu": lelu,
    "inv": inv,
    "log": log,
    "exp": np.exp,
    "bounded_identity": bounded_identity,
    "bounded_relu": bounded_relu,
    "bounded_abs": bounded_abs,
    "bounded_square": bounded_square,
}

BOUNDED = {name: f"bounded_{name}" for name in ("identity", "relu", "abs", "square")}
"""Activations that keep the bound, by those that do not."""

TO_REGISTER = ("cos", "gaussian", "square", *BOUNDED.values())
"""Activations that TensorNEAT lacks; its users register them by name."""

WITHIN_ONE = ("sigmoid", "tanh", "sin", "cos", "gaussian")
"""Activations whose values need no bound."""


# Aggregations take messages and whether each is live, both (message, point).
def total(messages, live):
    # One after another: the order in which standalone code adds.
    return reduce(np.add, np.where(live, messages, 0.0))


def product(messages, live):
    return reduce(np.multiply, np.where(live, messages, 1.0))


def largest(messages, live):
    return np.max(np.where(live, messages, -np.inf), 0)


def smallest(messages, live):
    return np.min(np.where(live, messages, np.inf), 0)


# The value of largest magnitude with its sign, as `maxabs` of TensorNEAT.
def farthest(messages, live):
    place = np.argmax(np.where(live, np.abs(messages), -1.0), 0)
    return np.take_along_axis(messages, place[None], 0)[0]


def mean(messages, live):
    return total(messages, live) / np.maximum(np.sum(live, 0), 1)


AGGREGATIONS = {
    "sum": total,
    "product": product,
    "max": largest,
    "min": smallest,
    "maxabs": farthest,
    "mean": mean,
}
