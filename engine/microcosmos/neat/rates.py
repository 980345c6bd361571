"""Rates of mutations, and the distribution of new genes."""

from collections.abc import Callable
from dataclasses import dataclass, field

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from ..genomes import ACTIVATIONS
from .plans import PlanRates
from .rng import LARGEST, Uniform

Draw = Callable[[Array], Array]
"""From uniform numbers in [0, 1) to random numbers around zero."""


def normal(uniform: Uniform) -> Array:
    """Return normal numbers with mean 0 and deviation 1."""
    return np.sqrt(2) * jax.lax.erf_inv(jnp.maximum(2 * uniform - 1, -LARGEST))


def uniform(uniform: Uniform) -> Array:
    """Return uniform numbers between −1 and 1."""
    return 2 * uniform - 1


def one_of(palette: tuple[int, ...], uniform: Uniform) -> Array:
    """Return uniformly drawn activations of the palette."""
    place = jnp.floor(uniform * len(palette)).astype(jnp.int32)
    return jnp.asarray(np.asarray(palette, np.int32))[place]


@dataclass(frozen=True)
class Rates:
    """Probabilities per gene (values, activations, toggles) or per child (structure)."""

    weight: float
    """A weight or bias is perturbed."""
    weight_step: float
    """Factor on a drawn number that perturbs a weight or bias."""
    replace: float
    """A weight or bias is drawn anew."""
    new_step: float = field(default=1.0, kw_only=True)
    """Factor on a drawn number that replaces a weight or bias."""
    activation: float
    toggle: float
    add_node: float
    add_connection: float
    delete_node: float = 0.0
    delete_connection: float = 0.0
    values: float = 1.0
    """Probability that the weights and biases of a child vary."""
    separate: bool = False
    """Keep values where a node or connection is added, so that fitness tests that alone."""
    bound: float | None = None
    """Limit of the size of weights and biases."""
    draw: Draw = normal
    palette: tuple[int, ...] = tuple(range(len(ACTIVATIONS)))
    """Indices of the activations that are drawn, in `genomes.ACTIVATIONS`."""
    recurrent: bool = False
    """Allow added connections that close cycles or join a node to itself."""
    blind: bool = False
    """Draw any two nodes for an added connection, and fail where they are joined or would
    close a cycle; otherwise draw among the possible connections."""
    drop_split: bool = False
    """Remove a split connection instead of disabling it."""
    plan: PlanRates | None = None
    """Rates of a body plan; None: genotypes have none."""


def bounded(values: Array, rates: Rates) -> Array:
    """Clip weights or biases to the limit."""
    return values if rates.bound is None else jnp.clip(values, -rates.bound, rates.bound)
