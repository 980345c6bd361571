"""Nodes with a prescribed velocity in a fluid, by the coupling that bodies use."""

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from microcosmos import coupling, fluid, groups


class Answer(eqx.Module):
    """The fluid after a step, and the motion and force of the nodes."""

    populations: fluid.Populations
    velocity: Float[Array, "node 2"]
    """Velocity of the nodes: the target without the part that the projection removed."""
    given: Float[Array, "2"]
    """The momentum that the fluid received from all nodes."""


def step(
    f: fluid.Populations,
    positions: Float[Array, "node 2"],
    target: Float[Array, "node 2"],
    rates: fluid.Rates,
    *,
    surroundings: fluid.Surroundings,
    projection: Callable,
    iterations: int,
) -> Answer:
    """One step of the fluid with nodes at `positions` that are to move with `target`."""
    rho, momentum = fluid.density(f), fluid.momentum(f)
    at = coupling.windows(positions, rho.shape)
    forced = coupling.multi_direct_forcing(
        coupling.interpolate(momentum, coupling.divided(at, rho)),
        target,
        positions,
        rho,
        at,
        groups=groups.one(len(positions)),
        iterations=iterations,
        projection=projection,
        limit=None,
    )
    force = 2.0 * coupling.spread(forced.forcing, at, rho.shape)
    f = fluid.advance(f, rho, momentum, force, rates, surroundings)
    return Answer(f, forced.target, 2.0 * jnp.sum(forced.forcing, 0))


def circle(radius: float, centre: tuple[float, float], dtype) -> Float[Array, "node 2"]:
    """Nodes on a circle, at most a cell apart."""
    nodes = int(jnp.ceil(2 * jnp.pi * radius))
    turn = 2 * jnp.pi * jnp.arange(nodes) / nodes
    around = radius * jnp.stack([jnp.cos(turn), jnp.sin(turn)], 1)
    return (around + jnp.asarray(centre)[None]).astype(dtype)
