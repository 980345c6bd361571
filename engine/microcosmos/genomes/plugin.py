"""Plug-in encodings: genes are numbers, which a plug-in turns into movements."""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from ..world import State, World
from .development import Controls, actuated
from .encoding import Drive, Networkless, Scalar, shifted
from .genotype import Vector, uniform_vector
from .waves import phases


class Clock(eqx.Module):
    """Phases over time and positions along the body, for plug-in encodings."""

    phase: Float[Array, "time"]
    """In rad."""
    joints: Float[Array, "joint"]
    """Positions of joints along the body, from −1 to 1."""
    edges: Float[Array, "edge"]
    """Positions of the middles of edges, from −1 to 1."""


Act = Callable[[Array, Clock], tuple[Array, Array]]
"""From genes to the control of joints (time, joint) and edges (time, edge), −1 to 1."""


@dataclass(frozen=True)
class PluginEncoding(Networkless):
    """A controller; all creatures have the same body."""

    controls: Controls
    genes: int
    act: Act

    def newcomer(self, *, key: PRNGKeyArray) -> Vector:
        return uniform_vector(self.genes, 1.0, key=key)

    def drive(
        self, world: World, start: State, genotype: Vector, phase: Scalar | None
    ) -> Drive:
        """Open loop; values beyond ±1 are clipped."""
        dtype, controls = start.positions.dtype, self.controls
        timer = shifted(controls.timer, phase)
        place = np.asarray(controls.sites[0])
        clock = Clock(
            phase=phases(timer, dtype),
            joints=jnp.asarray(place[controls.joint_nodes], dtype),
            edges=jnp.asarray(place[controls.edges].mean(1), dtype),
        )
        outputs = self.act(genotype.values.astype(dtype), clock)
        angle, length = (jnp.clip(one.astype(dtype), -1.0, 1.0) for one in outputs)
        return Drive(world, start, actuated(angle, length, controls.ramp, controls))
