"""From a CPPN to what it controls: rest angles and rest lengths over time."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..filaments import Rest
from .cppn import CPPN, evaluate

OUTPUTS = 2
"""Rest angle and rest length."""


@dataclass(frozen=True)
class Controls:
    """What a CPPN's inputs and outputs mean.

    `position` is (node,), `timer` (input, time), `ramp` (time,); rest angles and lengths are
    the body's own, in rad and cells. A CPPN that `senses` has one more input, which is known
    only while the world moves; any other's outputs for all times are one batch.
    """

    position: np.ndarray
    timer: np.ndarray | Array
    ramp: np.ndarray
    edges: np.ndarray
    joint_nodes: np.ndarray
    rest_angle: np.ndarray
    rest_length: np.ndarray
    angle_scale: float
    length_scale: float
    senses: bool = False

    @property
    def inputs(self) -> int:
        """Inputs of the CPPN."""
        return 1 + len(self.timer) + self.senses


def sine_cosine(steps: int, period: float) -> np.ndarray:
    """The timer as sine and cosine of its phase, (2, time)."""
    phase = 2 * np.pi * np.arange(steps) / period
    return np.stack([np.sin(phase), np.cos(phase)])


def linear(steps: int, period: float) -> np.ndarray:
    """The timer rising from 0 towards 1 over the whole simulation, (1, time)."""
    return np.arange(steps)[None] / steps


def develop(network: CPPN, controls: Controls) -> Rest:
    """Rest angles (time, joint) and rest lengths (time, edge) as applied, in one batch.

    A joint takes the output at its node; an edge the mean of its two ends, so that a
    mirrored network makes a mirrored body.
    """
    steps, nodes = len(controls.ramp), len(controls.position)
    position = np.tile(controls.position, steps)[None]
    dtype = network.bias.dtype
    clock = jnp.repeat(jnp.asarray(controls.timer, dtype), nodes, 1)
    inputs = jnp.concatenate([jnp.asarray(position, dtype), clock])
    outputs = evaluate(network, inputs, OUTPUTS)
    return _rest(
        outputs.reshape(OUTPUTS, steps, nodes), jnp.asarray(controls.ramp, dtype), controls
    )


def respond(
    network: CPPN,
    controls: Controls,
    timer: Float[Array, "input"],
    ramp: Float[Array, ""],
    sensed: Float[Array, "node"],
) -> Rest:
    """Rest angles (joint,) and rest lengths (edge,) at one time, from what nodes sense."""
    dtype = network.bias.dtype
    clock = jnp.broadcast_to(timer[:, None], (len(timer), len(sensed)))
    position = jnp.asarray(controls.position, dtype)[None]
    inputs = jnp.concatenate([position, clock, sensed[None]])
    outputs = evaluate(network, inputs, OUTPUTS)
    rest = _rest(outputs[:, None], ramp[None], controls)
    return Rest(rest.angle[0], rest.length[0])


def _rest(
    outputs: Float[Array, "2 time node"], ramp: Float[Array, "time"], controls: Controls
) -> Rest:
    angle, length = jnp.tanh(outputs)
    ramp, dtype = ramp[:, None], outputs.dtype
    length = 0.5 * (length[:, controls.edges[:, 0]] + length[:, controls.edges[:, 1]])
    stretch = 1 + controls.length_scale * ramp * length
    turn = controls.angle_scale * ramp * angle[:, controls.joint_nodes]
    return Rest(
        angle=_row(controls.rest_angle, dtype) + turn,
        length=_row(controls.rest_length, dtype) * stretch,
    )


def _row(values: np.ndarray, dtype) -> Float[Array, "1 _"]:
    return jnp.asarray(values, dtype)[None]
