"""A network whose layers are given: only weights and biases are inherited."""

from dataclasses import dataclass
from itertools import pairwise

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .cppn import ACTIVATIONS, Points


@dataclass(frozen=True)
class Layers:
    """Nodes of each layer, inputs first, and what hidden nodes do."""

    sizes: tuple[int, ...]
    activation: str = "tanh"
    scale: float = 1.0
    """Weights and biases are this times their genes."""

    @property
    def genes(self) -> int:
        """Weights and biases of all layers."""
        return sum((before + 1) * after for before, after in pairwise(self.sizes))


def forward(layers: Layers, genes: Float[Array, "gene"], inputs: Points) -> Points:
    """Outputs (output, point) for inputs (input, point).

    Genes hold, layer by layer, a row for each node: its bias, then its weights.
    """
    values, used, last = inputs, 0, len(layers.sizes) - 2
    for number, (before, after) in enumerate(pairwise(layers.sizes)):
        count = after * (before + 1)
        rows = layers.scale * genes[used : used + count].reshape(after, before + 1)
        used += count
        # A written-out sum: a matrix product may be split differently elsewhere.
        values = rows[:, :1] + jnp.sum(rows[:, 1:, None] * values[None], 1)
        if number < last:
            values = ACTIVATIONS[layers.activation](values)
    return values


def enabled(layers: Layers) -> tuple[int, int]:
    """Hidden nodes and connections."""
    sizes = np.array(layers.sizes)
    return int(sizes[1:-1].sum()), int((sizes[:-1] * sizes[1:]).sum())
