"""Nodes: repulsion from each other and from obstacles, sensing and collecting energy."""

from dataclasses import replace

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from .. import coupling, fields
from ..groups import Groups
from .model import State, World, anchors, grown_nodes, has_grown

Vectors = Float[Array, "node 2"]

TIE = 1e-4
"""Displacement in cells of bodies in exactly one place; the next steps make it grow."""
Scalars = Float[Array, "node"]
Scalar = Float[Array, ""]


def sense(world: World, state: State) -> Float[Array, "node"]:
    """Return the energy at each node; zero in a world without energy."""
    if state.energy is None:
        return jnp.zeros_like(state.positions[:, 0])
    at = coupling.windows(state.positions, world.size, world.form.kernel)
    return coupling.interpolate(state.energy[None], at)[:, 0]


def collect(world: World, state: State, at: coupling.Windows) -> State:
    """Return the state after nodes have taken energy where they stood before the step."""
    energy, field = world.energy, state.energy
    if energy is None or field is None:
        return state
    per_node = field
    if energy.rate is not None:
        # A node counts once, however many points it has.
        ones = jnp.ones((at.points, 1), field.dtype) / world.form.layers
        coverage = coupling.spread(ones, at, world.size)[0]
        field, per_node = fields.collect(field, coverage, energy.rate)
    if energy.diffusion is not None:
        field = fields.diffuse(field, energy.diffusion)
    taken = coupling.interpolate(per_node[None], at)
    # `at_nodes` takes vectors, so the number stands in both components.
    taken = coupling.at_nodes(jnp.tile(taken, (1, 2)), world.form.layers)[:, 0]
    before = 0.0 if state.collected is None else state.collected
    return replace(state, energy=field, collected=before + taken)


class Repelled(eqx.Module):
    """Displacements of nodes by repulsion."""

    push: Vectors
    """Within bodies."""
    drift: Vectors
    """The rigid motion of each body by contact with others and with obstacles."""
    touched: Bool[Array, "group"] | None = None
    """Bodies that touch others, where the world has `contact`."""
    limited: Bool[Array, "group"] | None = None
    """Those that contact moves less than it would, since one of their cluster is at the
    limit."""


def repel(world: World, positions: Vectors) -> Repelled:
    """Return the displacements of nodes by repulsion.

    The forcing on a body has neither force nor torque, which would remove its rigid motion; so
    this motion is returned apart and moves the body after the fluid's response. Displacements
    within bodies have no rigid part, so that no body moves itself.
    """
    if world.contact is not None:
        found = _met(world, positions)
    else:
        found = Repelled(*_apart(world, positions))
    if world.barrier is None:
        return found
    return replace(found, drift=found.drift + _kept_out(world, positions))


def others(world: World, positions: Vectors) -> Scalars:
    """Return the density of other bodies at each node; zero in a world without `contact`."""
    if world.contact is None:
        return jnp.zeros_like(positions[:, 0])
    return _around(world, positions).value


def _around(world: World, positions: Vectors, own: bool = False) -> fields.Density:
    """Return the density of other bodies at each node, or of the node's own."""
    member, here = world.groups.member, grown_nodes(world)
    same = member[:, None] == member[None]
    counted = (same if own else ~same) & here[:, None] & here[None]
    return fields.density(positions, world.size, counted)


def _met(world: World, positions: Vectors) -> Repelled:
    """Return the displacements where bodies meet.

    Bodies that touch each other, directly or by others, are one cluster: one factor keeps its
    motion within the limit, so that displacements times nodes sum to zero over it.
    """
    contact, groups = world.contact, world.groups
    assert contact is not None
    weights, near = _weights(world, positions), _around(world, positions)
    push = -contact.strength * near.gradient
    moved = coupling.force_free(push, weights, positions, groups)
    turned = coupling.torque_free(push, weights, positions, groups) - moved
    moved = moved + _parted(world, positions)

    def farthest(ways: Vectors) -> Float[Array, "group"]:
        return jnp.sqrt(groups.largest(weights * jnp.sum(ways * ways, 1)) + 1e-24)

    pairs = _touching(world, positions)
    touched = jnp.any(pairs & ~jnp.eye(groups.count, dtype=bool), 1)
    longest = jnp.maximum(farthest(moved), farthest(turned))
    factor = jnp.where(touched, jnp.minimum(1.0, contact.limit / longest), 1.0)
    together = _clusters(pairs)
    factor = jnp.min(jnp.where(together, factor[None], 1.0), 1)
    drift = groups.per_node(factor)[:, None] * (moved + turned)
    limited = touched & (factor < 1)
    if world.layout is not None and world.layout.bend is None:
        return Repelled(jnp.zeros_like(push), drift, touched, limited)
    own = push - contact.strength * _around(world, positions, own=True).gradient
    within = own - coupling.torque_free(own, weights, positions, groups)
    within = fields.capped(within, contact.limit)
    # The cap has changed the sums, so the rigid part goes a second time.
    within = within - coupling.torque_free(within, weights, positions, groups)
    return Repelled(within, drift, touched, limited)


def _touching(world: World, positions: Vectors) -> Bool[Array, "group group"]:
    """Return which bodies touch each other, and perhaps themselves."""
    member, here, count = world.groups.member, grown_nodes(world), world.groups.count
    touch = fields.touching(positions, world.size) & here[:, None] & here[None]
    pairs = jnp.zeros((count, count), positions.dtype)
    pairs = pairs.at[member[:, None], member[None]].add(touch.astype(positions.dtype))
    return pairs > 0


def _clusters(pairs: Bool[Array, "group group"]) -> Bool[Array, "group group"]:
    """Return which bodies touch each other, directly or by others; each itself."""
    reached = pairs | jnp.eye(len(pairs), dtype=bool)
    for _ in range(max(len(pairs) - 1, 1).bit_length()):  # Each round doubles the ways.
        ways = reached.astype(jnp.float32)
        reached = jnp.matmul(ways, ways) > 0
    return reached


def _apart(world: World, positions: Vectors) -> tuple[Vectors, Vectors]:
    if world.steric is None:
        return jnp.zeros_like(positions), jnp.zeros_like(positions)
    at = coupling.masked(coupling.windows(positions, world.size, coupling.HAT), world.present)
    density = coupling.spread(jnp.ones_like(positions[:, :1]), at, world.size)[0]
    push = -world.steric.strength * coupling.interpolate(world.steric.gradient(density), at)
    weights = _weights(world, positions)
    rigid = coupling.torque_free(push, weights, positions, world.groups)
    within = fields.capped(push - rigid, world.steric.limit)
    # The cap has changed the sums, so the rigid part goes a second time.
    within = within - coupling.torque_free(within, weights, positions, world.groups)
    if world.groups.count == 1:
        return within, jnp.zeros_like(positions)
    moved = coupling.force_free(push, weights, positions, world.groups)
    rotation, moved = rigid - moved, moved + _parted(world, positions)
    turned = _turned(rotation, moved, weights, world.groups, world.steric.limit)
    return within, fields.capped(moved, world.steric.limit) + turned


def _parted(world: World, positions: Vectors) -> Vectors:
    """Return displacements that part bodies which stand in exactly one place.

    There they push each other nowhere. Of n such bodies each takes another of n directions, so
    that the displacements of equal bodies add up to nothing.
    """
    at = jax.lax.stop_gradient(positions[anchors(world)])
    same = jnp.all(at[:, None] == at[None], 2)
    grown = has_grown(world)
    if grown is not None:  # Bodies of which nothing has grown stand nowhere.
        same = same & grown[:, None] & grown[None]
    order = jnp.arange(len(at)) if world.order is None else world.order
    count, before = jnp.sum(same, 1), jnp.sum(same & (order[None] < order[:, None]), 1)
    # Along a filament they would slide over each other: few have just this direction.
    turn = 1 + 2 * jnp.pi * before.astype(at.dtype) / jnp.maximum(count, 1).astype(at.dtype)
    way = TIE * jnp.stack([jnp.cos(turn), jnp.sin(turn)], 1)
    parted = count > 1
    return world.groups.per_node(jnp.where(parted[:, None], way, 0.0))


def _turned(
    turned: Vectors, moved: Vectors, weights: Scalars, groups: Groups, limit: Scalar
) -> Vectors:
    """Limit the rotation of each body by contact, like its translation.

    Pushes between the nodes of a body cancel, but their torques do only up to the lattice:
    pairs across it push each other slightly off their line. So the torque is at most that of
    the net push, which is contact alone, at the body's farthest node.
    """
    square = jnp.sum(turned * turned, 1)
    mean = groups.mean(square, weights)
    tip = jnp.sqrt(groups.largest(weights * square) + 1e-24)
    push = jnp.sqrt(groups.largest(weights * jnp.sum(moved * moved, 1)) + 1e-24)
    # Constants keep roots and quotients differentiable where nothing touches.
    most = jnp.minimum(limit / tip, push * tip / (mean + 1e-24))
    return turned * groups.per_node(jnp.minimum(1.0, most))[:, None]


def _kept_out(world: World, positions: Vectors) -> Vectors:
    """Return the rigid motion of each body away from solid cells.

    It is the mean of the nodes' displacements, each weighted by its length: a body of many
    nodes, one of which touches, moves like that node. It turns as far as the displacements
    that are left turn its farthest node. Both are limited.
    """
    barrier, groups = world.barrier, world.groups
    assert barrier is not None
    at = coupling.masked(coupling.windows(positions, world.size, coupling.HAT), world.present)
    away = coupling.interpolate(barrier.away, at)
    weight = jnp.sqrt(jnp.sum(away * away, 1) + 1e-24)
    # Above the weights of 1e-12 that untouched nodes have by the guard of their root.
    touching = groups.total(weight) + 1e-9
    moved = groups.per_node(groups.total(weight[:, None] * away) / touching[:, None])
    weights = _weights(world, positions)
    centre = groups.per_node(groups.mean(positions, weights))
    arm, left = positions - centre, away - moved
    torque = groups.total(weight * (arm[:, 0] * left[:, 1] - arm[:, 1] * left[:, 0]))
    tip = jnp.sqrt(groups.largest(weights * jnp.sum(arm * arm, 1)) + 1e-24)
    turn = torque / touching / tip
    turn = jnp.clip(turn, -barrier.limit, barrier.limit) / tip
    turned = groups.per_node(turn)[:, None] * jnp.stack([-arm[:, 1], arm[:, 0]], 1)
    return fields.capped(moved, barrier.limit) + turned


def _weights(world: World, positions: Vectors) -> Scalars:
    """Return 1 for nodes that are present, else 0."""
    return grown_nodes(world).astype(positions.dtype)
