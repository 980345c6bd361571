"""Constraint projection of planar Cosserat rods: stretch, shear and bending.

Position-based dynamics: Mueller et al., J. Vis. Commun. Image R. 18, 109 (2007); rods:
Umetani, Schmidt and Stam, SCA 2014; the planar form is the one of the Microcosmos paper.
Constraints of one colour share no node (or edge), so that a sweep over the colours is
Gauss-Seidel, and every displacement has an equal and opposite one.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from ..portable import arctangent
from .chunks import in_chunks

Positions = Float[Array, "node 2"]
Angles = Float[Array, "edge"]


class Pairing(eqx.Module):
    """The partner and the constraint of each member (node or edge) in one colour.

    `sign` is 1 for the first of a pair, −1 for the second and 0 for a member that no
    constraint of the colour touches.
    """

    partner: Int[Array, "member"]
    constraint: Int[Array, "member"]
    sign: Float[Array, "member"]


class Rods(eqx.Module):
    """The graph of a body and its stiffnesses."""

    edges: Int[Array, "edge 2"]
    """Edges of all bodies; colours may cover only the first chunk of equal bodies."""
    edge_colours: tuple[Pairing, ...]
    joint_colours: tuple[Pairing, ...]
    stretch: Float[Array, "edge"]
    shear: Float[Array, "edge"]
    bend: Float[Array, "joint"]
    joints: Int[Array, "joint 2"] | None = None
    """Pairs of edges; only measures need them."""
    rings: "Rings | None" = None
    """The joints around branches; None: there are no branches."""


class Rings(eqx.Module):
    """Joints in rings: around a branch of d edges stand d joints, whose angles have one sum."""

    of: Int[Array, "joint"]
    """The ring of each joint; `count`: it stands in none."""
    sign: Float[Array, "joint"]
    """1 or −1: the way in which a joint is passed on the way around its ring; 0 in none."""
    whole: Float[Array, "ring"]
    """Whole turns around each ring, in rad."""
    count: int = eqx.field(static=True)


class Rest(eqx.Module):
    """The rest shape that constraints aim at: of one step, or of all steps (time first)."""

    angle: Float[Array, "*time joint"]
    length: Float[Array, "*time edge"]


def wrap(angle: Float[Array, "*shape"]) -> Float[Array, "*shape"]:
    """Return the same angle within ±π; its gradient is 1."""
    # Without a derivative of the rounding the slope is 1 also at a jump.
    return angle - 2 * jnp.pi * jax.lax.stop_gradient(jnp.round(angle / (2 * jnp.pi)))


def edge_angles(positions: Positions, rods: Rods) -> Angles:
    """Return the direction of every edge, in radians; 0 without a length."""
    x, y = (positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]).T
    # The arctangent has no gradient at the origin, where two nodes coincide.
    return arctangent(y, jnp.where((x == 0) & (y == 0), 1.0, x))


def normals(
    angles: Angles,
    rods: Rods,
    nodes: int,
    present: Bool[Array, "edge"] | None = None,
    least: float = 1e-12,
) -> Float[Array, "node 2"]:
    """Return unit vectors across the filament at its nodes; zero where edges cancel: where the
    square of their sum is well below `least`."""
    across = jnp.stack([-jnp.sin(angles), jnp.cos(angles)], 1)
    if present is not None:
        across = jnp.where(present[:, None], across, 0.0)
    total = jnp.zeros((nodes, 2), angles.dtype).at[rods.edges].add(across[:, None])
    # Edges that fold back cancel: the constant keeps value and gradient finite.
    return total / jnp.sqrt(jnp.sum(total * total, 1, keepdims=True) + least)


def follow_geometry(angles: Angles, positions: Positions, rods: Rods) -> Angles:
    """Return angles of the geometry, on the branch nearest to the given ones."""
    return angles + wrap(edge_angles(positions, rods) - angles)


def closed(rest: Rest, rods: Rods) -> Rest:
    """Return the rest shape of one step with the misfit of each ring shared by its joints.

    The directions of edges cannot meet angles around a branch that do not add up to whole
    turns. A sweep would leave all of the misfit to the joints that come first. A ring with a
    joint of no stiffness, which takes up any misfit, stays.
    """
    rings = rods.rings
    if rings is None:
        return rest

    def per_ring(reduce, values):
        return reduce(values, rings.of, rings.count + 1)

    # Not the nearest whole turns: commands may open joints by more than half a turn in all.
    whole = jnp.append(rings.whole, 0.0)
    misfit = per_ring(jax.ops.segment_sum, rings.sign * rest.angle) - whole
    joints = per_ring(jax.ops.segment_sum, jnp.abs(rings.sign))
    stiff = per_ring(jax.ops.segment_min, rods.bend) > 0
    share = jnp.where(stiff, misfit / jnp.maximum(joints, 1.0), 0.0)
    return Rest(rest.angle - rings.sign * share[rings.of], rest.length)


def bend(angles: Angles, rods: Rods, rest: Rest) -> Angles:
    """Sweep the joints once: each edge corrects half of the error θ₂ − θ₁ − θ_rest."""
    # Each colour sees what the colours before it have left (Gauss-Seidel). Measured: Jacobi
    # sweeps, which average at branches, do not keep the sum of displacements at zero.
    for colour in rods.joint_colours:
        difference = colour.sign * (angles[colour.partner] - angles)
        error = wrap(difference - rest.angle[colour.constraint])
        angles = angles + colour.sign * (0.5 * rods.bend[colour.constraint]) * error
    return angles


def stretch(positions: Positions, angles: Angles, rods: Rods, rest: Rest) -> Positions:
    """Sweep the edges once: correct lengths along the tangent, and shear to the director."""
    # Stretching leaves angles alone, so that directors are the same for all colours.
    directors = jnp.stack([jnp.cos(angles), jnp.sin(angles)], 1) * rest.length[:, None]
    for colour in rods.edge_colours:
        sign = colour.sign[:, None]
        v = sign * (positions[colour.partner] - positions)
        # The guard also keeps members without a constraint, whose v is 0, differentiable.
        length = jnp.sqrt(jnp.sum(v * v, 1, keepdims=True) + 1e-12)
        along = v - v * (rest.length[colour.constraint][:, None] / length)
        full = v - directors[colour.constraint]
        shear = rods.shear[colour.constraint][:, None]
        share = sign * (0.5 * rods.stretch[colour.constraint][:, None])
        positions = positions + share * (along + shear * (full - along))
    return positions


def project(
    positions: Positions, angles: Angles, rods: Rods, rest: Rest, *, iterations: int
) -> tuple[Positions, Angles]:
    """Return positions and angles after `iterations` sweeps of bending, then stretching."""
    nodes, chunk = len(positions), len(rods.edge_colours[0].partner)
    if chunk == nodes:
        return _sweeps(positions, angles, rods, rest, iterations)

    def sweep_chunk(given):
        positions, angles, stiffness, rest = given
        edges = rods.edges[: len(angles)]
        own = Rods(edges, rods.edge_colours, rods.joint_colours, *stiffness)
        return _sweeps(positions, angles, own, rest, iterations)

    given = (positions, angles, (rods.stretch, rods.shear, rods.bend), rest)
    moved, turned = in_chunks(sweep_chunk, given, nodes, chunk)
    return moved, turned


def _sweeps(positions, angles, rods, rest, iterations):
    def sweep(carry, _):
        positions, angles = carry
        # Bend first: stretching then shears the edges towards angles of the same sweep.
        angles = bend(angles, rods, rest)
        return (stretch(positions, angles, rods, rest), angles), None

    return jax.lax.scan(sweep, (positions, angles), None, length=iterations)[0]
