"""A CPPN as the controller of a given body; `development` maps its outputs to rest shapes.

In a network with cycles all nodes are updated together, once per step of the world. Every node
of the body then has a copy of the network, which keeps its values between steps.
"""

from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from ..world import State, World, sense
from .commands import network_commands
from .cppn import ACTIVATIONS, BOUND, CPPN, Points, matrix, minimal
from .development import (
    OUTPUTS,
    Controls,
    Function,
    function_of,
    network_inputs,
    rest_shape,
    rest_shapes,
    shape_of_outputs,
    shapes_of_outputs,
)
from .encoding import Drive, Scalar, shifted


def advance(network: CPPN, values: Points, inputs: Points) -> Points:
    """Return the values (node, point) of the next step: f(b + W v), v with new inputs.

    Input rows hold the inputs; unused rows hold 0.
    """
    given = inputs.shape[0]
    values = values.at[:given].set(inputs)
    weights = matrix(network, values.dtype)
    # A written-out sum: a library may split a matrix product differently elsewhere.
    z = network.bias[:, None] + jnp.sum(weights[:, :, None] * values[None], 1)
    activated = jnp.zeros_like(z)
    for number, function in enumerate(ACTIVATIONS.values()):
        activated = jnp.where((network.activation == number)[:, None], function(z), activated)
    computed = network.node_used & (np.arange(len(activated)) >= given)
    return jnp.where(computed[:, None], jnp.clip(activated, -BOUND, BOUND), values)


def drive_recurrent(network: CPPN, controls: Controls, world: World, start: State) -> Drive:
    """Return the simulation: rest shapes in advance, or closed loop if the network senses."""
    dtype = start.positions.dtype
    rows = slice(controls.inputs, controls.inputs + OUTPUTS)
    nothing = jnp.zeros((len(network.bias), controls.nodes), dtype)
    timer, ramp = jnp.asarray(controls.timer.T, dtype), jnp.asarray(controls.ramp, dtype)
    if not controls.senses:

        def step(values, timer):
            values = advance(network, values, network_inputs(controls, timer[:, None], None))
            return values, values[rows]

        outputs = jnp.moveaxis(jax.lax.scan(step, nothing, timer)[1], 0, 1)
        return Drive(world, start, shapes_of_outputs(outputs, ramp, controls))

    def remember(
        world: World, state: State, given: tuple[Array, Array]
    ) -> Float[Array, "row node"]:
        inputs = network_inputs(controls, given[0][:, None], _sensed(controls, world, state))
        return advance(network, state.memory, inputs)

    def control(world: World, state: State, given: tuple[Array, Array]):
        return shape_of_outputs(state.memory[rows], given[1], controls)

    start = replace(start, memory=nothing)
    return Drive(world, start, (timer, ramp), control, remember)


def _sensed(controls: Controls, world: World, state: State) -> Float[Array, "node"]:
    if controls.senses != ("energy",):
        raise ValueError(
            f"`senses` must be energy alone outside slots, got {', '.join(controls.senses)}."
        )
    return sense(world, state)


@dataclass(frozen=True)
class CPPNControl:
    """The encoding of controllers as CPPNs; all creatures have the same body."""

    controls: Controls
    room: tuple[int, int]
    recurrent: bool = False
    """True if networks may have cycles; their nodes then keep values between steps."""

    segments = None

    def newcomer(self, *, key: PRNGKeyArray) -> CPPN:
        return minimal(key, self.controls.inputs, OUTPUTS, *self.room)

    def drive(self, world: World, start: State, genotype: CPPN, phase: Scalar | None) -> Drive:
        """Return the simulation, in closed loop if the network senses."""
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
    """Return the simulation of a body that a network without memory drives."""
    dtype = start.positions.dtype
    if not controls.senses:
        return Drive(world, start, rest_shapes(read, controls, dtype))

    def control(world: World, state: State, inputs: tuple[Array, Array]):
        return rest_shape(read, controls, *inputs, _sensed(controls, world, state))

    inputs = jnp.asarray(controls.timer.T, dtype), jnp.asarray(controls.ramp, dtype)
    return Drive(world, start, inputs, control)
