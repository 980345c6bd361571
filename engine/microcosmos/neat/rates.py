"""How often each mutation happens to a child, and what a new gene is like."""

from collections.abc import Callable
from dataclasses import dataclass, field

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from ..genomes import ACTIVATIONS
from .rng import LARGEST, Uniform

Draw = Callable[[Array], Array]
"""Numbers that are equally likely between 0 and 1 → random numbers around zero."""


def normal(uniform: Uniform) -> Array:
    """Numbers with mean 0 and deviation 1."""
    return np.sqrt(2) * jax.lax.erf_inv(jnp.maximum(2 * uniform - 1, -LARGEST))


def uniform(uniform: Uniform) -> Array:
    """Numbers between −1 and 1, each equally likely."""
    return 2 * uniform - 1


def one_of(palette: tuple[int, ...], uniform: Uniform) -> Array:
    """Activations, each of the palette equally likely."""
    place = jnp.floor(uniform * len(palette)).astype(jnp.int32)
    return jnp.asarray(np.asarray(palette, np.int32))[place]


@dataclass(frozen=True)
class Rates:
    """Probabilities a gene (values, activations, toggles) or a child (structure)."""

    weight: float
    """A weight or bias is perturbed."""
    weight_step: float
    """What a drawn number is multiplied by to perturb a weight or bias."""
    replace: float
    """A weight or bias is drawn anew."""
    new_step: float = field(default=1.0, kw_only=True)
    """What a drawn number is multiplied by then."""
    activation: float
    toggle: float
    add_node: float
    add_connection: float
    delete_node: float = 0.0
    delete_connection: float = 0.0
    values: float = 1.0
    """A child's weights and biases vary at all."""
    apart: bool = False
    """They do not where a node or connection is added, so that this alone is judged."""
    bound: float | None = None
    """Weights and biases are kept within this of zero."""
    draw: Draw = normal
    palette: tuple[int, ...] = tuple(range(len(ACTIVATIONS)))
    """Activations that are drawn, by their place among `genomes.ACTIVATIONS`."""
    recurrent: bool = False
    """Added connections may close cycles and lead from a node to itself."""
    blind: bool = False
    """An added connection joins any two nodes, and fails where they are joined already or a
    cycle would close, in place of being one of those that are possible."""
    drop_split: bool = False
    """A split connection is removed, not disabled."""


def bounded(values: Array, rates: Rates) -> Array:
    """Weights or biases as far as they are allowed."""
    return values if rates.bound is None else jnp.clip(values, -rates.bound, rates.bound)
