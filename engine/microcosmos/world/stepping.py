"""A step of the world with its measures, and rollouts of many steps."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from .. import coupling, filaments, fluid
from ..groups import Groups
from .model import (
    Measures,
    State,
    World,
    centre,
    mean,
    present_edges,
    present_joints,
    present_points,
    within_box,
)
from .nodes import Repelled, collect, repel

Points = Float[Array, "point 2"]


class Pushed(eqx.Module):
    """Exchange between bodies and fluid in a step, at the points where they meet."""

    speed: Float[Array, ""]
    """Speed of the fastest fluid before the step."""
    forcing: Points
    """Force on the fluid."""
    target: Points
    """Displacement of the points that the fluid follows, without the drift by contact."""
    moved: Float[Array, "node 2"]
    """Displacement of the nodes before the projection removes its rigid part."""
    held: Float[Array, "node"]
    """1 where a limit acted."""
    repelled: Repelled
    velocity: Points
    """Velocity of the fluid before the step."""


def measure(world: World, end: State, rest: filaments.Rest, pushed: Pushed) -> Measures:
    """Return the measures of a step that ended in `end`."""
    groups = world.groups.repeated(world.form.layers)
    speed = jnp.sqrt(jnp.sum(pushed.moved * pushed.moved, 1) + 1e-24)
    return Measures(
        speed=pushed.speed,
        node_speed=mean(speed, world.present),
        held=mean(pushed.held, world.present),
        force=groups.total(pushed.forcing),
        rest=rest,
        centre=centre(world, end),
        positions=end.positions,
        boxes=end.boxes,
        heading=mean(end.angles, present_edges(world)),
        curvature=curvature(world, end.positions, end.angles),
        power=jnp.sum(pushed.forcing * pushed.target),
    )


def curvature(
    world: World, positions: Float[Array, "node 2"], angles: Float[Array, "edge"]
) -> Float[Array, "joint"]:
    """Return the angle at each joint over the mean length of its edges, in rad per cell."""
    rods = world.rods
    if rods.joints is None:
        return jnp.zeros_like(rods.bend)
    first, second = rods.joints[:, 0], rods.joints[:, 1]
    v = positions[rods.edges[:, 1]] - positions[rods.edges[:, 0]]
    # Without a length an edge has no gradient, and two of them would divide by 0.
    length = jnp.sqrt(jnp.sum(v * v, 1) + 1e-24)
    angle = filaments.wrap(angles[second] - angles[first])
    bend = 2 * angle / (length[first] + length[second])
    kept = present_joints(world)
    return bend if kept is None else jnp.where(kept, bend, 0.0)


Vectors = Float[Array, "node 2"]


class Motion(eqx.Module):
    """The motion of the bodies in a step, before the fluid's response."""

    target: Vectors
    angles: Float[Array, "edge"]
    shortened: Float[Array, "node"]
    """Factor that shortens each displacement to the limit."""


Observer = Callable[[World, State, filaments.Rest, Pushed], Any]


def step(
    world: World, state: State, rest: filaments.Rest, measure: Observer = measure
) -> tuple[State, Any]:
    """Take one step: the fluid carries bodies, constraints move them, the fluid responds.

    `measure` makes the measures of the step from its end and the exchange with the fluid.
    """
    if not world.form.fluid:
        return step_alone(world, state, rest, measure)
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    at = windows(world, state)
    # Without the half step of the bodies' own force, which is not known yet.
    moving = fluid.moving(momentum, world.surroundings)
    velocity = coupling.interpolate(moving, coupling.divided(at, rho))
    layers, groups = world.form.layers, world.groups.repeated(world.form.layers)
    repelled = repel(world, state.positions)
    drift = repelled.drift
    motion = move(world, state, rest, coupling.at_nodes(velocity, layers) + repelled.push)
    # The fluid is asked to follow the motion by flow and constraints, without `drift`: forcing
    # has neither net force nor torque, so it would remove the rigid motion by contact.
    forced = coupling.multi_direct_forcing(
        velocity,
        coupling.at_points(motion.target, layers),
        _points(world, state),
        rho,
        at,
        groups=groups,
        iterations=world.form.forcing_iterations,
        projection=world.form.projection,
        limit=world.limits.force,
        present=present_points(world, layers),
    )
    forcing = world.form.force_factor * forced.forcing
    force = coupling.spread(forcing, at, world.size)
    rates = fluid.rates(world.viscosity, world.form.magic)
    populations = fluid.advance(
        state.populations, rho, momentum, force, rates, world.surroundings
    )
    positions = state.positions + coupling.at_nodes(forced.target, layers) + drift
    if world.present is not None:
        positions = jnp.where(world.present[:, None], positions, state.positions)
    end = replace(state, populations=populations, positions=positions, angles=motion.angles)
    # Nodes collect where they stood before the step, so the windows `at` serve once more.
    held = _held(motion, forced, groups)
    pushed = Pushed(
        fluid.fastest(rho, moving),
        forcing,
        forced.target,
        motion.target,
        held,
        repelled,
        velocity,
    )
    end = within_box(world, collect(world, end, at))
    return end, measure(world, end, rest, pushed)


def step_alone(
    world: World, state: State, rest: filaments.Rest, measure: Observer = measure
) -> tuple[State, Any]:
    """Take one step without a fluid: repulsion and constraints move the bodies."""
    repelled = repel(world, state.positions)
    motion = move(world, state, rest, repelled.push)
    positions = state.positions + motion.target + repelled.drift
    if world.present is not None:
        positions = jnp.where(world.present[:, None], positions, state.positions)
    end = replace(state, positions=positions, angles=motion.angles)
    layers = world.form.layers
    target = coupling.at_points(motion.target, layers)
    nothing, held = jnp.zeros_like(target), (motion.shortened < 1).astype(positions.dtype)
    still = jnp.zeros((), positions.dtype)
    pushed = Pushed(still, nothing, target, motion.target, held, repelled, nothing)
    end = within_box(world, collect(world, end, windows(world, state)))
    return end, measure(world, end, rest, pushed)


def move(world: World, state: State, rest: filaments.Rest, velocity: Vectors) -> Motion:
    """Carry the bodies with the fluid, project onto constraints, limit the speed."""
    positions = state.positions + velocity
    positions, angles = _constrained(world, state, rest, positions)
    target = positions - state.positions
    if world.limits.displacement is None:
        return Motion(target, angles, jnp.ones_like(target[:, 0]))
    # The constant keeps the root differentiable for a node at rest.
    speed = jnp.sqrt(jnp.sum(target * target, 1) + 1e-24)
    shortened = jnp.minimum(1.0, world.limits.displacement / speed)
    return Motion(target * shortened[:, None], angles, shortened)


def _constrained(
    world: World, state: State, rest: filaments.Rest, positions: Vectors
) -> tuple[Vectors, Float[Array, "edge"]]:
    """Return positions and edge angles that meet the constraints."""
    if world.layout is not None:
        if world.layout.bend is not None:
            assert world.rods.joints is not None
            carried = filaments.follow_geometry(state.angles, positions, world.rods)
            rest = filaments.softened(rest, carried, world.rods.joints, world.layout)
        positions = filaments.matched(positions, rest, world.layout, world.present)
        return positions, filaments.follow_geometry(state.angles, positions, world.rods)
    # Once a step: measured, sweeps that follow the geometry converge ten times as slowly.
    followed = filaments.follow_geometry(state.angles, positions, world.rods)
    angles = state.angles + world.form.theta_feedback * (followed - state.angles)
    rods = world.rods
    if world.nu_c is not None:
        rods = replace(rods, bend=rods.bend / (1 + world.viscosity / world.nu_c))
    rest = filaments.closed(rest, rods)
    return filaments.project(
        positions, angles, rods, rest, iterations=world.form.constraint_iterations
    )


def _points(world: World, state: State) -> Float[Array, "point 2"]:
    if world.form.layers == 1:
        return state.positions
    grown = present_edges(world)
    normals = filaments.normals(state.angles, world.rods, len(state.positions), grown)
    return coupling.points(state.positions, normals, world.form.layers)


def windows(world: World, state: State) -> coupling.Windows:
    """Return the cells around the points at which bodies and fluid meet."""
    at = coupling.windows(_points(world, state), world.size, world.form.kernel)
    return coupling.masked(at, present_points(world, world.form.layers))


def _held(motion: Motion, forced: coupling.Forced, groups: Groups) -> Float[Array, "node"]:
    """Return 1 for nodes whose displacement, or whose body's forcing, a limit has reduced."""
    dtype, layers = motion.target.dtype, len(groups.member) // len(motion.target)
    # All points of a node belong to one body, so its first point stands for the node.
    pressed = groups.per_node((forced.scale < 1).astype(dtype))[::layers]
    return jnp.maximum(pressed, (motion.shortened < 1).astype(dtype))


def follow(world: World, state: State, rest: filaments.Rest) -> filaments.Rest:
    """Return the inputs, which are rest shapes: control in open loop."""
    return rest


def keep_memory(world: World, state: State, given: Any) -> PyTree[Array]:
    return state.memory


def rollout(
    world: World,
    state: State,
    inputs: PyTree[Array],
    observe: Callable[[State, Measures], Any] = lambda state, measures: None,
    control: Callable[[World, State, Any], filaments.Rest] = follow,
    remember: Callable[[World, State, Any], PyTree[Array]] = keep_memory,
    segment: int | None = None,
) -> tuple[State, Any]:
    """Return the state after all steps of `inputs` (time first), and observations (time first).

    In each step `remember` sets the state's memory, then `control` makes the rest shape from
    the world, the state and the inputs. With `segment`, reverse mode keeps the state only
    after every `segment` steps and repeats the steps (Griewank and Walther, ACM Trans. Math.
    Softw. 26, 19, 2000, with two levels).
    """

    def advance(state, given):
        state = replace(state, memory=remember(world, state, given))
        state, measures = step(world, state, control(world, state, given))
        return state, observe(state, measures)

    if segment is None:
        return jax.lax.scan(advance, state, inputs)
    steps = len(jax.tree.leaves(inputs)[0])
    whole = steps - steps % segment

    def cut(x):
        return x[:whole].reshape(whole // segment, segment, *x.shape[1:])

    def joined(many, few):
        return jnp.concatenate([many.reshape(-1, *many.shape[2:]), few])

    # XLA does not merge repeated steps across a loop, so JAX needs no barriers against that.
    segments = jax.checkpoint(partial(jax.lax.scan, advance), prevent_cse=False)
    state, seen = jax.lax.scan(segments, state, jax.tree.map(cut, inputs))
    state, last = jax.lax.scan(advance, state, jax.tree.map(lambda x: x[whole:], inputs))
    return state, jax.tree.map(joined, seen, last)
