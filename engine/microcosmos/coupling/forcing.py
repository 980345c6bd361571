"""Multi-direct forcing: find the force at the nodes that makes the fluid follow the body.

Multi-direct forcing: Wang, Fan and Luo, Int. J. Multiphase Flow 34, 283 (2008). Each
increment is scaled by β = 1 / (row sum of J S), which converges for any packing of nodes.
Freeing each increment of its mean (and its rigid rotation) keeps the body from pushing
itself: the displacements that constraints make sum to zero, but (J S)⁻¹ of them do not.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from .delta import Windows, read, spread

Vectors = Float[Array, "node 2"]
Scalars = Float[Array, "node"]
Projection = Callable[[Vectors, Scalars, Vectors], Vectors]


class Forced(eqx.Module):
    """The forcing q at the nodes and the target velocity that it works towards."""

    forcing: Vectors
    target: Vectors


def unprojected(error: Vectors, beta: Scalars, positions: Vectors) -> Vectors:
    """No rigid motion is removed: the literal method."""
    return jnp.zeros_like(error)


def force_free(error: Vectors, beta: Scalars, positions: Vectors) -> Vectors:
    """The rigid translation whose removal makes Σ β e = 0."""
    mean = jnp.sum(beta[:, None] * error, 0) / jnp.sum(beta)
    return jnp.broadcast_to(mean[None], error.shape)


def torque_free(error: Vectors, beta: Scalars, positions: Vectors) -> Vectors:
    """The rigid motion whose removal makes Σ β e = 0 and Σ a × β e = 0."""
    translation = force_free(error, beta, positions)
    error = error - translation
    centre = jnp.sum(beta[:, None] * positions, 0) / jnp.sum(beta)
    arm = positions - centre[None]
    turning = jnp.sum(beta * (arm[:, 0] * error[:, 1] - arm[:, 1] * error[:, 0]))
    spin = turning / jnp.sum(beta * jnp.sum(arm * arm, 1))
    return translation + spin * jnp.stack([-arm[:, 1], arm[:, 0]], 1)


def multi_direct_forcing(
    velocity: Vectors,
    target: Vectors,
    positions: Vectors,
    rho: Float[Array, "x y"],
    at: Windows,
    *,
    iterations: int,
    projection: Projection,
    limit: float | None,
) -> Forced:
    """The forcing at nodes for a fluid at `velocity` there to move with `target`.

    Forcing and velocities are in cells a step; the force on the fluid is a multiple of the
    forcing, spread. With `limit`, the largest forcing of the body is at most that, by one
    factor for all nodes, so that sums stay zero.
    """
    weights_by_density = at.weights / read(rho, at)
    coverage = spread(jnp.ones_like(target[:, :1]), at, rho.shape)[0]
    beta = 1.0 / jnp.sum(at.weights * read(coverage, at), (1, 2))

    def response(q: Vectors) -> Vectors:
        spread_q = spread(q, at, rho.shape)
        parts = [jnp.sum(weights_by_density * read(plane, at), (1, 2)) for plane in spread_q]
        return jnp.stack(parts, 1)

    def improve(q, target, reached):
        error = target - velocity - reached
        rigid = projection(error, beta, positions)
        return q + beta[:, None] * (error - rigid), target - rigid

    def iterate(carry, _):
        q, target = carry
        return improve(q, target, response(q)), None

    first = improve(jnp.zeros_like(target), target, jnp.zeros_like(target))
    # A loop, though a short one: written out, XLA forms the weights anew in every iteration.
    (q, target), _ = jax.lax.scan(iterate, first, None, length=iterations - 1)
    if limit is not None:
        largest = jnp.sqrt(jnp.max(jnp.sum(q * q, 1)) + 1e-24)
        q = q * jnp.minimum(1.0, limit / largest)
    return Forced(q, target)
