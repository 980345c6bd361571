"""A network with fixed layers that sets rest angles and lengths; its weights are genes."""

from dataclasses import dataclass, replace
from itertools import pairwise

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from ..world import State, World
from .commands import layered_commands
from .control import drive_feed_forward
from .cppn import ACTIVATIONS, Points
from .development import Controls
from .encoding import Drive, Scalar, shifted
from .genotype import Vector, uniform_vector


@dataclass(frozen=True)
class Layers:
    """Sizes of all layers, inputs first, and the activation of hidden nodes."""

    sizes: tuple[int, ...]
    activation: str = "tanh"
    scale: float = 1.0
    """Weights and biases per unit of their genes."""

    @property
    def genes(self) -> int:
        """Number of weights and biases."""
        return sum((before + 1) * after for before, after in pairwise(self.sizes))


def forward(layers: Layers, genes: Float[Array, "gene"], inputs: Points) -> Points:
    """Return outputs (output, point) for inputs (input, point).

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


@dataclass(frozen=True)
class Weights:
    """A controller; all creatures have the same body."""

    controls: Controls
    layers: Layers
    room: None = None
    segments: None = None

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        return uniform_vector(self.layers.genes, 1.0, key=key)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Open loop, or closed loop where the network senses."""
        controls = replace(self.controls, timer=shifted(self.controls.timer, phase))
        genes = genotype.values.astype(start.positions.dtype)

        def read(inputs):
            return forward(self.layers, genes, inputs)

        driven = drive_feed_forward(read, controls, world, start)
        layers = self.layers
        values = layers.scale * genes
        given = layered_commands(layers.sizes, layers.activation, values, self.controls, phase)
        return replace(driven, controller=given)

    def size(self, genotype: Vector) -> tuple[Array, Array]:
        """Return hidden nodes and connections, the same for all genotypes."""
        sizes = np.array(self.layers.sizes)
        connections = int((sizes[:-1] * sizes[1:]).sum())
        return jnp.asarray(int(sizes[1:-1].sum())), jnp.asarray(connections)
