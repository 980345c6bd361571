"""A CPPN as the controller of a given body; `development` maps its outputs to rest shapes."""

from dataclasses import dataclass, replace

import jax.numpy as jnp
from jaxtyping import Array, PRNGKeyArray

from ..world import State, World, sense
from .commands import network_commands
from .cppn import CPPN, minimal
from .development import OUTPUTS, Controls, Function, function_of, rest_shape, rest_shapes
from .encoding import Drive, Scalar, shifted
from .recurrent import drive_recurrent


@dataclass(frozen=True)
class CPPNControl:
    """A controller; all creatures have the same body."""

    controls: Controls
    room: tuple[int, int]
    recurrent: bool = False
    """True if networks may have cycles; their nodes then keep values between steps."""

    segments = None

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        return minimal(key, self.controls.inputs, OUTPUTS, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Open loop, or closed loop where the network senses."""
        controls = replace(self.controls, timer=shifted(self.controls.timer, phase))
        if self.recurrent:
            driven = drive_recurrent(genotype, controls, world, start)
        else:
            driven = drive_feed_forward(function_of(genotype), controls, world, start)
        given = network_commands(genotype, self.controls, phase, recurrent=self.recurrent)
        return replace(driven, controller=given)

    def size(self, genotype: CPPN) -> tuple[Array, Array]:
        return network_size(genotype, self.controls.inputs + OUTPUTS)


def network_size(network: CPPN, fixed: int) -> tuple[Array, Array]:
    """Return the number of hidden nodes and of enabled connections.

    `fixed` is the number of inputs and outputs.
    """
    enabled = network.connection_used & network.enabled
    return jnp.sum(network.node_used) - fixed, jnp.sum(enabled)


def drive_feed_forward(read: Function, controls: Controls, world: World, start: State) -> Drive:
    """Drive a world by a network without memory."""
    dtype = start.positions.dtype
    if not controls.senses:
        return Drive(world, start, rest_shapes(read, controls, dtype))

    def control(world: World, state: State, inputs: tuple[Array, Array]):
        return rest_shape(read, controls, *inputs, sense(world, state))

    inputs = jnp.asarray(controls.timer.T, dtype), jnp.asarray(controls.ramp, dtype)
    return Drive(world, start, inputs, control)
