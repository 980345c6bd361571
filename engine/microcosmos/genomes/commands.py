"""Controllers as the native kernel carries them out, see `world.Controller`."""

from itertools import pairwise

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from ..naming import ACTIVATIONS
from ..world import Controller, Network, Series
from .cppn import CPPN
from .development import Controls
from .encoding import Scalar

NONE = -1


def network_commands(
    network: CPPN, controls: Controls, phase: Scalar | None, *, recurrent: bool = False
) -> Controller:
    """Describe a CPPN at every node of a body; its timer is that of `controls`, unshifted."""
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


def layered_commands(
    sizes: tuple[int, ...],
    activation: str,
    values: Float[Array, "gene"],
    controls: Controls,
    phase: Scalar | None,
) -> Controller:
    """Describe a network of layers whose biases and weights are `values`, as in `weights`."""
    starts = np.cumsum((0, *sizes))
    # Rows are inputs, outputs, then hidden nodes.
    place = np.arange(starts[-1])
    place[starts[-2] :] = sizes[0] + np.arange(sizes[-1])
    place[sizes[0] : starts[-2]] += sizes[-1]
    activations = np.full(starts[-1], NONE)
    bias_gene, links, used = np.zeros(starts[-1], int), [], 0
    for layer, (before, after) in enumerate(pairwise(sizes)):
        rows = place[starts[layer + 1] : starts[layer + 2]]
        genes = used + np.arange(after * (before + 1)).reshape(after, before + 1)
        used += after * (before + 1)
        last = layer == len(sizes) - 2
        activations[rows] = ACTIVATIONS.index("identity" if last else activation)
        bias_gene[rows] = genes[:, 0]
        sources = np.tile(place[starts[layer] : starts[layer + 1]], after)
        links.append(np.stack([sources, np.repeat(rows, before), genes[:, 1:].ravel()]))
    source, target, gene = np.concatenate(links, 1)
    return _at_nodes(
        controls,
        phase,
        False,
        activation=jnp.asarray(activations),
        bias=values[bias_gene],
        source=jnp.asarray(source),
        target=jnp.asarray(target),
        weight=values[gene],
    )


def series_commands(
    basis: Float[Array, "time term"],
    angles: Float[Array, "angle"],
    lengths: Float[Array, "length"],
    controls: Controls,
) -> Controller:
    """Describe weighted sums of functions of time, as in `waves.wave`."""
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
