"""A network of given layers that sets rest angles and rest lengths; its weights are genes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..world import State, World
from .control import drive_read
from .development import Controls
from .encoding import Drive, Scalar, shifted
from .genotype import Vector
from .layers import Layers, enabled, forward
from .vectors import evenly, from_values, to_values


@dataclass(frozen=True)
class Weights:
    """Controller alone: everybody has the same body."""

    controls: Controls
    layers: Layers

    @property
    def room(self) -> None:
        """Genes are a vector."""
        return None

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Every gene evenly drawn from −1 to 1."""
        return evenly(self.layers.genes, 1.0, key=key)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Open loop, or a closed one where the network senses."""
        controls = replace(self.controls, timer=shifted(self.controls.timer, phase))
        genes = genotype.values.astype(start.positions.dtype)

        def read(inputs):
            return forward(self.layers, genes, inputs)

        return drive_read(read, controls, world, start)

    def size(self, genotype: Vector) -> tuple[Array, Array]:
        """The same for all."""
        hidden, connections = enabled(self.layers)
        return jnp.asarray(hidden), jnp.asarray(connections)

    def write(self, genotype: Vector) -> dict[str, Any]:
        """All genes."""
        return to_values(genotype)

    def read(self, genes: Mapping[str, Any]) -> Vector:
        """All genes."""
        return from_values(genes)
