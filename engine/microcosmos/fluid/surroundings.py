"""Surroundings of the fluid: walls, forces, a free stream.

Halfway bounce-back: Ladd, J. Fluid Mech. 271, 285 (1994), for walls at rest. The wall lies
half a cell outside the last fluid cell, exactly so for a straight wall at Λ = 3/16.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .adjoint import collision
from .dynamics import Rates, stream
from .lattice import DIRECTIONS, PAIRS, Plane, Populations, Vectors, equilibrium


class Sponge(eqx.Module):
    """Cells that relax the fluid towards a free stream at rest density."""

    strength: Float[Array, "x y"]
    """Share of the difference from the free stream that a step removes."""
    velocity: Float[Array, "2"]


class Surroundings(eqx.Module):
    """Walls and forces that act on the fluid besides bodies; None: absent, at no cost."""

    force: Float[Array, "2"] | None = None
    """The same force density in every cell."""
    solid: Bool[Array, "x y"] | None = None
    """Cells of wall at rest, in which there is no fluid."""
    sponge: Sponge | None = None
    force_field: Float[Array, "2 x y"] | None = None
    """A force density of its own in every cell."""


def moving(momentum: tuple[Plane, Plane], surroundings: Surroundings) -> tuple[Plane, Plane]:
    """Return the momentum of the velocity: half a step of the surroundings' force has acted.

    Guo, Zheng and Shi, Phys. Rev. E 65, 046308 (2002). `momentum` is the moment of the
    populations. The force of bodies is left out: they follow this velocity.
    """
    force = None if surroundings.force is None else surroundings.force[:, None, None]
    if surroundings.force_field is not None:
        field = surroundings.force_field
        force = field if force is None else force + field
    if force is None:
        return momentum
    if surroundings.solid is not None:
        force = jnp.where(surroundings.solid, 0.0, force)
    return momentum[0] + 0.5 * force[0], momentum[1] + 0.5 * force[1]


def advance(
    f: Populations,
    rho: Plane,
    momentum: tuple[Plane, Plane],
    force: Vectors,
    rates: Rates,
    surroundings: Surroundings,
) -> Populations:
    """Collide, stream, bounce back at walls, and relax the sponge.

    `rho` and `momentum` are the moments of `f`, without force; `force` is that of bodies.
    """
    if surroundings.force is not None:
        force = force + surroundings.force[:, None, None]
    if surroundings.force_field is not None:
        force = force + surroundings.force_field
    collided = collision(f, rho, momentum, force, rates)
    f = stream(collided)
    # Walls need the populations before streaming: each goes back where it came from.
    if surroundings.solid is not None:
        f = _bounce(f, collided, surroundings.solid)
    if surroundings.sponge is not None:
        f = _absorb(f, surroundings.sponge)
    return f


def _bounce(streamed: Populations, collided: Populations, solid: Bool[Array, "x y"]):
    """Replace each population from a solid cell by its opposite."""
    out = [streamed[0]]
    for pair in PAIRS:
        for i, opposite in (pair, pair[::-1]):
            # A cell gets population i from the cell behind it, so the mask streams likewise.
            from_wall = jnp.roll(solid, DIRECTIONS[i], (0, 1))
            out.append(jnp.where(from_wall, collided[opposite], streamed[i]))
    # Deviations are 0 in solid cells, at rest and density 1, so that no mass collects there.
    return tuple(jnp.where(solid, 0.0, plane) for plane in out)


def _absorb(f: Populations, sponge: Sponge) -> Populations:
    rest = jnp.ones_like(sponge.strength)
    stream_velocity = jnp.broadcast_to(sponge.velocity[:, None, None], (2, *rest.shape))
    free = equilibrium(rest, stream_velocity)
    return tuple(p + sponge.strength * (q - p) for p, q in zip(f, free, strict=True))
