"""Nodes with a prescribed velocity in a fluid, by the coupling that bodies use."""

from collections.abc import Callable

import jax.numpy as jnp
from jaxtyping import Array, Float

from microcosmos import coupling, fluid, groups


def step(
    f: fluid.Populations,
    positions: Float[Array, "node 2"],
    target: Float[Array, "node 2"],
    rates: fluid.Rates,
    *,
    surroundings: fluid.Surroundings,
    projection: Callable,
    kernel: coupling.Kernel,
) -> tuple[fluid.Populations, Float[Array, "node 2"], Float[Array, "2"]]:
    """Carry out one step with nodes at `positions` that are to move with `target`.

    Return the fluid, the nodes' velocity (the target without the part that the projection
    removes), and the momentum that the fluid receives from all nodes.
    """
    rho, momentum = fluid.density(f), fluid.momentum(f)
    at = coupling.windows(positions, rho.shape, kernel)
    forced = coupling.multi_direct_forcing(
        coupling.interpolate(momentum, coupling.divided(at, rho)),
        target,
        positions,
        rho,
        at,
        groups=groups.single(len(positions)),
        iterations=5,
        projection=projection,
        limit=None,
    )
    force = 2.0 * coupling.spread(forced.forcing, at, rho.shape)
    f = fluid.advance(f, rho, momentum, force, rates, surroundings)
    return f, forced.target, 2.0 * jnp.sum(forced.forcing, 0)


def circle(radius: float, centre: tuple[float, float], dtype) -> Float[Array, "node 2"]:
    """Nodes on a circle, at most a cell apart."""
    nodes = int(jnp.ceil(2 * jnp.pi * radius))
    turn = 2 * jnp.pi * jnp.arange(nodes) / nodes
    around = radius * jnp.stack([jnp.cos(turn), jnp.sin(turn)], 1)
    return (around + jnp.asarray(centre)[None]).astype(dtype)
