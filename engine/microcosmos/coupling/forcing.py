"""Multi-direct forcing: the force at the nodes that makes the fluid follow the bodies.

The method is that of Wang, Fan and Luo, Int. J. Multiphase Flow 34, 283 (2008). Each
increment is scaled by β = 1 / (row sum of J S / ρ), which converges for any packing of nodes,
and by a step length, with which fewer iterations do. A projection removes the mean (and the
rigid rotation) of each increment, body by body, so that no body pushes itself: displacements
by constraints sum to zero, but (J S)⁻¹ of them do not.
"""

from collections.abc import Callable

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from .. import exact
from ..groups import Groups
from .delta import Windows, divided, interpolate, spread

Vectors = Float[Array, "node 2"]
Scalars = Float[Array, "node"]
Projection = Callable[[Vectors, Scalars, Vectors, Groups], Vectors]


class Forced(eqx.Module):
    """The forcing q at the nodes and the target velocity that it works towards."""

    forcing: Vectors
    target: Vectors
    scale: Float[Array, "group"]
    """Factor that reduces each body's forcing to the limit."""


def unprojected(error: Vectors, beta: Scalars, positions: Vectors, groups: Groups) -> Vectors:
    """Return zeros: remove no rigid motion, as in the paper's literal form."""
    return jnp.zeros_like(error)


def force_free(error: Vectors, beta: Scalars, positions: Vectors, groups: Groups) -> Vectors:
    """Return the rigid translations whose removal makes Σ β e = 0 for each body."""
    return groups.per_node(groups.mean(error, beta))


def torque_free(error: Vectors, beta: Scalars, positions: Vectors, groups: Groups) -> Vectors:
    """Return the rigid motions whose removal makes Σ β e = 0 and Σ a × β e = 0 for a body."""
    translation = force_free(error, beta, positions, groups)
    error = error - translation
    arm = positions - groups.per_node(groups.mean(positions, beta))
    turning = groups.total(beta * (arm[:, 0] * error[:, 1] - arm[:, 1] * error[:, 0]))
    inertia = groups.total(beta * jnp.sum(arm * arm, 1))
    # A body of one node, or of none, does not turn.
    spin = groups.per_node(turning / jnp.where(inertia == 0, 1.0, inertia))
    return translation + spin[:, None] * jnp.stack([-arm[:, 1], arm[:, 0]], 1)


def multi_direct_forcing(
    velocity: Vectors,
    target: Vectors,
    positions: Vectors,
    rho: Float[Array, "x y"],
    at: Windows,
    *,
    groups: Groups,
    iterations: int,
    projection: Projection,
    limit: Float[Array, ""] | float | None,
    present: Bool[Array, "node"] | None = None,
) -> Forced:
    """Return the forcing at nodes that makes a fluid at `velocity` move with `target`.

    Forcing and velocities are in cells per step; the force on the fluid is the spread forcing
    times `Form.force_factor`. With `limit`, the largest forcing of a body is at most that,
    by one factor for all its nodes, so that sums stay zero. Nodes that are not `present`, whose
    windows are empty, have none.
    """
    by_density = divided(at, rho)
    coverage = spread(jnp.ones_like(target[:, :1]), at, rho.shape)
    beta = _reciprocal(interpolate(coverage, by_density)[:, 0], present)
    lengths = jnp.asarray(step_lengths(iterations), target.dtype)

    def improve(q, target, reached, length):
        error = target - velocity - reached
        # The target loses its rigid motion too: a body goes where the fluid carries it.
        rigid = projection(error, beta, positions, groups)
        return q + length * beta[:, None] * (error - rigid), target - rigid

    def iterate(carry, length):
        q, target = carry
        reached = interpolate(spread(q, at, rho.shape), by_density)
        return improve(q, target, reached, length), None

    # Nothing is forced yet, so the first iteration has nothing to spread.
    first = improve(jnp.zeros_like(target), target, jnp.zeros_like(target), lengths[0])
    # A loop, though a short one: written out, XLA forms the weights again in every iteration.
    (q, target), _ = jax.lax.scan(iterate, first, lengths[1:])
    if limit is None:
        return Forced(q, target, jnp.ones(groups.count, q.dtype))
    # The constant keeps the root differentiable where nothing is forced.
    largest = jnp.sqrt(groups.largest(jnp.sum(q * q, 1)) + 1e-24)
    scale = jnp.minimum(1.0, limit / largest)
    return Forced(q * groups.per_node(scale)[:, None], target, scale)


def step_lengths(iterations: int) -> np.ndarray:
    """Return the step lengths of the iterations, (iteration,).

    The slip of a mode of eigenvalue λ, 0 to 1, is multiplied by 1 - ωλ in a step of length ω.
    All steps but the last form Fejér's kernel, whose product is at most 1 / (n² λ) with n
    iterations and never negative: forcing that overshoots a mode makes the fluid oscillate from
    step to step. The last step, of length 1, follows the last projection.
    """
    turns = np.pi * np.arange(1, iterations) / iterations
    rising = np.sort(1 / exact.sine(turns) ** 2)
    # Short and long ones alternate, so that rounding errors do not grow on the way.
    pairs = np.stack([rising, rising[::-1]], 1).reshape(-1)[: len(rising)]
    return np.append(pairs, 1.0)


def _reciprocal(values: Scalars, present: Bool[Array, "node"] | None) -> Scalars:
    if present is None:
        return 1.0 / values
    # Reverse mode differentiates both branches: an absent node, of value 0, must not divide.
    return jnp.where(present, 1.0 / jnp.where(present, values, 1.0), 0.0)


# Two layers thicken a filament of no thickness into a solid (Mittal and Iaccarino, Annu. Rev.
# Fluid Mech. 37, 239, 2005, as the Microcosmos paper uses it). Both move with the node: layers
# that turn with the cross-section would stretch, and cancel propulsion.
OFFSET = 0.5
"""Distance of a layer from the filament in cells; at 1 the coupling is unstable."""


def points(positions: Vectors, normals: Vectors, layers: int) -> Float[Array, "point 2"]:
    """Return `layers` points for every node, side by side."""
    if layers == 1:
        return positions
    # Both points of a node stand together: `at_nodes` takes their mean without an index.
    pair = jnp.stack([positions + OFFSET * normals, positions - OFFSET * normals], 1)
    return pair.reshape(-1, 2)


def at_points(values: Vectors, layers: int) -> Float[Array, "point 2"]:
    """Repeat the value of each node at its points."""
    return values if layers == 1 else jnp.repeat(values, layers, 0)


def at_nodes(values: Float[Array, "point 2"], layers: int) -> Vectors:
    """Return the mean over the points of each node."""
    return values if layers == 1 else jnp.mean(values.reshape(-1, layers, 2), 1)
