"""Development: turn the outputs of a controller into rest angles and rest lengths."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from .. import exact, portable
from ..filaments import Rest
from .cppn import CPPN, Points, evaluate

OUTPUTS = 2
"""Rest angle and rest length; a network that grows the body has further outputs."""

Outputs = Float[Array, "2 time node"]
Function = Callable[[Points], Points]
"""A network as a function of inputs (input, point) with outputs (output, point)."""


@dataclass(frozen=True)
class Controls:
    """The meaning of a controller's inputs and outputs.

    `sites` is (site, node), `timer` (input, time), `ramp` (time,); rest angles and lengths are
    the body's, in rad and cells. A network has one more input for each of its `senses`, known
    only during the simulation; any other network is evaluated for all times in one batch.
    Arrays of JAX may differ between creatures.
    """

    sites: np.ndarray | Array
    """Inputs that tell a node its place in the body; the first is its position along it."""
    timer: np.ndarray | Array
    ramp: np.ndarray
    edges: np.ndarray | Array
    joint_nodes: np.ndarray | Array
    rest_angle: np.ndarray | Array
    rest_length: np.ndarray | Array
    angle_scale: float
    length_scale: float
    senses: tuple[str, ...] = ()
    wave: np.ndarray | Array | None = None
    """Phase lag in rad (node,) of a travelling sine and cosine; None: there are none."""
    gain: np.ndarray | Array | None = None
    """Factor (joint,) on what a network commands for rest angles; None: 1 for all joints."""

    @property
    def nodes(self) -> int:
        """Number of nodes of the body."""
        return self.sites.shape[1]

    @property
    def inputs(self) -> int:
        """Number of inputs of a network."""
        clocks = 1 if self.wave is None else 2
        return len(self.sites) + clocks * len(self.timer) + len(self.senses)


def sine_cosine(steps: int, period: float) -> np.ndarray:
    """Return sine and cosine of the phase, (2, time); `period` is in steps."""
    phase = 2 * np.pi * np.arange(steps) / period
    return np.stack([exact.sine(phase), exact.cosine(phase)])


def linear(steps: int, period: float) -> np.ndarray:
    """Return a rise from 0 towards 1 over the whole simulation, (1, time)."""
    return np.arange(steps)[None] / steps


def develop(network: CPPN, controls: Controls) -> Rest:
    """Return the rest angles (time, joint) and rest lengths (time, edge) of a CPPN."""
    return rest_shapes(function_of(network), controls, network.bias.dtype)


def function_of(network: CPPN) -> Function:
    """Return a feed-forward network as a function."""
    return lambda inputs: evaluate(network, inputs, OUTPUTS)


def rest_shapes(read: Function, controls: Controls, dtype: Any) -> Rest:
    """Return the rest shapes at all times, in one batch."""
    outputs = read(network_inputs(controls, jnp.asarray(controls.timer, dtype), None))
    outputs = outputs.reshape(OUTPUTS, len(controls.ramp), controls.nodes)
    return shapes_of_outputs(outputs, controls.ramp, controls)


def rest_shape(
    read: Function,
    controls: Controls,
    timer: Float[Array, "input"],
    ramp: Float[Array, ""],
    sensed: Float[Array, "node"] | None,
) -> Rest:
    """Return the rest shape at one time."""
    outputs = read(network_inputs(controls, timer[:, None], sensed))
    return shape_of_outputs(outputs, ramp, controls)


def network_inputs(
    controls: Controls, timer: Float[Array, "input time"], sensed: Float[Array, "node"] | None
) -> Points:
    """Return the inputs of a network at all nodes and times, the node varying fastest.

    `sensed` is of one time.
    """
    times, nodes = timer.shape[1], controls.nodes
    sites = jnp.tile(jnp.asarray(controls.sites, timer.dtype), (1, times))
    rows = [sites, jnp.repeat(timer, nodes, 1)]
    if controls.wave is not None:
        rows.append(travelling(timer, controls.wave).reshape(2, times * nodes))
    return jnp.concatenate([*rows, *([] if sensed is None else [sensed[None]])])


def travelling(
    timer: Float[Array, "2 time"], lag: np.ndarray | Float[Array, "node"]
) -> Float[Array, "2 time node"]:
    """Return sine and cosine of the phase less the lag of each node, in rad."""
    # Lags of a fixed body are known before compilation: `exact` rounds them once.
    if isinstance(lag, np.ndarray):
        s, c = (jnp.asarray(f(lag), timer.dtype)[None] for f in (exact.sine, exact.cosine))
    else:
        s, c = (f(lag.astype(timer.dtype))[None] for f in (portable.sine, portable.cosine))
    sine, cosine = timer[:, :, None]
    return jnp.stack([sine * c - cosine * s, cosine * c + sine * s])


def shape_of_outputs(outputs: Points, ramp: Float[Array, ""], controls: Controls) -> Rest:
    """Return the rest shape at one time from outputs (output, node)."""
    rest = shapes_of_outputs(outputs[:, None], ramp[None], controls)
    return Rest(rest.angle[0], rest.length[0])


def shapes_of_outputs(
    outputs: Outputs, ramp: Float[Array, "time"] | np.ndarray, controls: Controls
) -> Rest:
    """Return the rest shapes at all times from a network's outputs.

    A joint takes the output at its node, times its gain; an edge the mean of its two ends, so
    that a mirrored network makes a mirrored body.
    """
    angle, length = jnp.tanh(outputs)
    length = 0.5 * (length[:, controls.edges[:, 0]] + length[:, controls.edges[:, 1]])
    angle = angle[:, controls.joint_nodes]
    if controls.gain is not None:
        angle = angle * _row(controls.gain, angle.dtype)
    return actuated(angle, length, ramp, controls)


def actuated(
    angle: Float[Array, "time joint"],
    length: Float[Array, "time edge"],
    ramp: Float[Array, "time"] | np.ndarray,
    controls: Controls,
) -> Rest:
    """Return rest shapes from the control of every joint and edge, −1 to 1."""
    dtype = angle.dtype
    ramp = jnp.asarray(ramp, dtype)[:, None]
    return Rest(
        angle=_row(controls.rest_angle, dtype) + controls.angle_scale * ramp * angle,
        length=_row(controls.rest_length, dtype) * (1 + controls.length_scale * ramp * length),
    )


def _row(values: np.ndarray | Array, dtype: Any) -> Float[Array, "1 _"]:
    return jnp.asarray(values, dtype)[None]
