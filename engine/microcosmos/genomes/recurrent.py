"""Networks with cycles: all nodes are updated together, once per step of the world.

Every node of the body has a copy of the network, which keeps its values between steps.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..world import State, World, sense
from .cppn import ACTIVATIONS, BOUND, CPPN, Points, matrix
from .development import OUTPUTS, Controls, network_inputs, shape_of_outputs, shapes_of_outputs
from .encoding import Drive


def advance(network: CPPN, values: Points, inputs: Points) -> Points:
    """Return the values (node, point) of the next step: f(b + W v), v with new inputs.

    Input rows hold the inputs; unused rows hold 0.
    """
    given = inputs.shape[0]
    values = values.at[:given].set(inputs)
    weights = matrix(network, values.dtype)
    # A written-out sum: a matrix product may be split differently elsewhere.
    z = network.bias[:, None] + jnp.sum(weights[:, :, None] * values[None], 1)
    found = jnp.zeros_like(z)
    for number, function in enumerate(ACTIVATIONS.values()):
        found = jnp.where((network.activation == number)[:, None], function(z), found)
    computed = network.node_used & (np.arange(len(found)) >= given)
    return jnp.where(computed[:, None], jnp.clip(found, -BOUND, BOUND), values)


def drive_recurrent(network: CPPN, controls: Controls, world: World, start: State) -> Drive:
    """Drive a world: in open loop, computed before it, or in closed loop if it senses."""
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
        inputs = network_inputs(controls, given[0][:, None], sense(world, state))
        return advance(network, state.memory, inputs)

    def control(world: World, state: State, given: tuple[Array, Array]):
        return shape_of_outputs(state.memory[rows], given[1], controls)

    start = replace(start, memory=nothing)
    return Drive(world, start, (timer, ramp), control, remember)
