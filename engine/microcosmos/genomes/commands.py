"""Descriptions of controllers that the native kernel carries out, see `world.Controller`."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..world import Controller, Network, Series
from .cppn import CPPN
from .development import Controls
from .encoding import Scalar

NONE = -1


def network_commands(
    network: CPPN, controls: Controls, phase: Scalar | None, *, recurrent: bool = False
) -> Controller:
    """Describe a CPPN at every node of a body.

    The kernel applies `phase` to the timer of `controls`, which must not be shifted before.
    """
    computed = network.node_used & (np.arange(network.node_used.shape[0]) >= controls.inputs)
    live = network.connection_used & network.enabled
    return _at_nodes(
        controls,
        phase,
        recurrent,
        activation=jnp.where(computed, network.activation, NONE),
        bias=network.bias,
        source=jnp.where(live, network.source, NONE),
        target=network.target,
        weight=network.weight,
    )


def series_commands(
    basis: Float[Array, "time term"],
    angles: Float[Array, "angle"],
    lengths: Float[Array, "length"],
    controls: Controls,
) -> Controller:
    """Describe weighted sums of functions of time, as in `waves.wave`."""
    # Genes of one joint or edge are adjacent; the kernel adds term by term, for all of them.
    genes = jnp.concatenate([angles, lengths]).reshape(-1, basis.shape[1]).T
    return _controller(Series(basis, genes), controls, None)


def _at_nodes(
    controls: Controls, phase: Scalar | None, recurrent: bool, **arrays: Array
) -> Controller:
    wave, dtype = controls.wave, arrays["bias"].dtype
    joints = len(controls.joint_nodes)
    gain = jnp.ones(joints) if controls.gain is None else controls.gain
    network = Network(
        **arrays,
        sites=jnp.asarray(controls.sites, dtype),
        gain=jnp.asarray(gain, dtype),
        lag=None if wave is None else jnp.asarray(wave, dtype),
        timer=jnp.asarray(controls.timer.T, dtype),
        joint_node=jnp.asarray(controls.joint_nodes, jnp.int32),
        recurrent=recurrent,
        senses=controls.senses,
    )
    return _controller(network, controls, phase)


def _controller(
    commands: Network | Series, controls: Controls, phase: Scalar | None
) -> Controller:
    dtype = (commands.bias if isinstance(commands, Network) else commands.basis).dtype
    return Controller(
        commands,
        ramp=jnp.asarray(controls.ramp, dtype),
        rest_angle=jnp.asarray(controls.rest_angle, dtype),
        rest_length=jnp.asarray(controls.rest_length, dtype),
        angle_scale=controls.angle_scale,
        length_scale=controls.length_scale,
        phase=phase,
    )
