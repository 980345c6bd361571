"""An encoding of one's own: numbers, and a function that makes movements of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from ..world import State, World
from .development import Controls, actuated
from .encoding import Drive, Scalar, none, shifted
from .genotype import Vector
from .vectors import evenly, from_values, to_values
from .waves import phases


class Clock(eqx.Module):
    """When and where something moves."""

    phase: Float[Array, "time"]
    """In rad."""
    joints: Float[Array, "joint"]
    """Where joints are along the body, from −1 to 1."""
    edges: Float[Array, "edge"]
    """Where the middles of edges are, from −1 to 1."""


Act = Callable[[Array, Clock], tuple[Array, Array]]
"""From genes to what every joint (time, joint) and every edge (time, edge) does, −1 to 1."""


@dataclass(frozen=True)
class PluginEncoding:
    """Controller alone: everybody has the same body."""

    controls: Controls
    genes: int
    act: Act

    @property
    def room(self) -> None:
        """There is no network."""
        return None

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        """Every gene evenly drawn from −1 to 1."""
        return evenly(self.genes, 1.0, key=key)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Open loop; what goes beyond ±1 is cut."""
        dtype, controls = start.positions.dtype, self.controls
        timer = shifted(controls.timer, phase)
        place = np.asarray(controls.position)
        clock = Clock(
            phase=phases(timer, dtype),
            joints=jnp.asarray(place[controls.joint_nodes], dtype),
            edges=jnp.asarray(place[controls.edges].mean(1), dtype),
        )
        said = self.act(genotype.values.astype(dtype), clock)
        angle, length = (jnp.clip(one.astype(dtype), -1.0, 1.0) for one in said)
        return Drive(world, start, actuated(angle, length, controls.ramp, controls))

    def size(self, genotype: Vector) -> tuple[Array, Array]:
        """No network."""
        return none()

    def write(self, genotype: Vector) -> dict[str, Any]:
        """All genes."""
        return to_values(genotype)

    def read(self, genes: Mapping[str, Any]) -> Vector:
        """All genes."""
        return from_values(genes)
