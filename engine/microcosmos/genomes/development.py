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
    """What a CPPN's inputs and outputs mean; open loop, so that all times are one batch.

    `inputs` is (input, time · node); `ramp` is (time,); rest angles and lengths are the
    body's own, in rad and cells.
    """

    inputs: np.ndarray
    ramp: np.ndarray
    edges: np.ndarray
    joint_nodes: np.ndarray
    rest_angle: np.ndarray
    rest_length: np.ndarray
    angle_scale: float
    length_scale: float


def sine_cosine(steps: int, period: float) -> np.ndarray:
    """The timer as sine and cosine of its phase, (2, time)."""
    phase = 2 * np.pi * np.arange(steps) / period
    return np.stack([np.sin(phase), np.cos(phase)])


def linear(steps: int, period: float) -> np.ndarray:
    """The timer rising from 0 towards 1 over the whole simulation, (1, time)."""
    return np.arange(steps)[None] / steps


def network_inputs(position: np.ndarray, timer: np.ndarray) -> np.ndarray:
    """(1 + timer, time · node): every node's position beside every time."""
    steps, nodes = timer.shape[1], len(position)
    return np.concatenate([np.tile(position, steps)[None], np.repeat(timer, nodes, 1)])


def develop(network: CPPN, controls: Controls) -> Rest:
    """Rest angles (time, joint) and rest lengths (time, edge) as applied.

    A joint takes the output at its node; an edge the mean of its two ends, so that a
    mirrored network makes a mirrored body.
    """
    dtype = network.bias.dtype
    steps = len(controls.ramp)
    outputs = evaluate(network, jnp.asarray(controls.inputs, dtype), OUTPUTS)
    angle, length = (jnp.tanh(row).reshape(steps, -1) for row in outputs)
    ramp = jnp.asarray(controls.ramp, dtype)[:, None]
    length = 0.5 * (length[:, controls.edges[:, 0]] + length[:, controls.edges[:, 1]])
    stretch = 1 + controls.length_scale * ramp * length
    turn = controls.angle_scale * ramp * angle[:, controls.joint_nodes]
    return Rest(
        angle=_row(controls.rest_angle, dtype) + turn,
        length=_row(controls.rest_length, dtype) * stretch,
    )


def _row(values: np.ndarray, dtype) -> Float[Array, "1 _"]:
    return jnp.asarray(values, dtype)[None]
