"""One step of a world, in the order of the method."""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .. import coupling, filaments, fluid
from ..groups import Groups
from .measuring import Pushed, measure
from .model import Measures, State, World
from .nodes import collect, repel
from .present import edges_there, there

Vectors = Float[Array, "node 2"]


class Motion(eqx.Module):
    """The motion of the bodies in a step, before the fluid's response."""

    target: Vectors
    angles: Float[Array, "edge"]
    shortened: Float[Array, "node"]
    """Factor that shortens each displacement to the limit."""


def step(world: World, state: State, rest: filaments.Rest) -> tuple[State, Measures]:
    """Take one step: the fluid carries bodies, constraints move them, the fluid responds."""
    if not world.form.fluid:
        return step_alone(world, state, rest)
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    at = _windows(world, state)
    velocity = coupling.interpolate(momentum, coupling.divided(at, rho))
    layers, groups = world.form.layers, world.groups.repeated(world.form.layers)
    push, drift = repel(world, state.positions)
    motion = move(world, state, rest, coupling.at_nodes(velocity, layers) + push)
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
        present=there(world, layers),
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
    held = _held(motion, forced, groups)
    pushed = Pushed(fluid.fastest(rho, momentum), forcing, forced.target, motion.target, held)
    return collect(world, end, at), measure(world, end, rest, pushed)


def step_alone(world: World, state: State, rest: filaments.Rest) -> tuple[State, Measures]:
    """Take one step without a fluid: repulsion and constraints move the bodies."""
    push, drift = repel(world, state.positions)
    motion = move(world, state, rest, push)
    positions = state.positions + motion.target + drift
    if world.present is not None:
        positions = jnp.where(world.present[:, None], positions, state.positions)
    end = replace(state, positions=positions, angles=motion.angles)
    layers = world.form.layers
    target = coupling.at_points(motion.target, layers)
    nothing, held = jnp.zeros_like(target), (motion.shortened < 1).astype(positions.dtype)
    pushed = Pushed(jnp.zeros((), positions.dtype), nothing, target, motion.target, held)
    return collect(world, end, _windows(world, state)), measure(world, end, rest, pushed)


def move(world: World, state: State, rest: filaments.Rest, velocity: Vectors) -> Motion:
    """Carry the bodies with the fluid, project onto constraints, limit the speed."""
    positions = state.positions + velocity
    positions, angles = _constrained(world, state, rest, positions)
    target = positions - state.positions
    if world.limits.displacement is None:
        return Motion(target, angles, jnp.ones_like(target[:, 0]))
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
    followed = filaments.follow_geometry(state.angles, positions, world.rods)
    angles = state.angles + world.form.theta_feedback * (followed - state.angles)
    rods = world.rods
    if world.nu_c is not None:
        rods = replace(rods, bend=rods.bend / (1 + world.viscosity / world.nu_c))
    return filaments.project(
        positions, angles, rods, rest, iterations=world.form.constraint_iterations
    )


def _points(world: World, state: State) -> Float[Array, "point 2"]:
    if world.form.layers == 1:
        return state.positions
    grown = edges_there(world)
    normals = filaments.normals(state.angles, world.rods, len(state.positions), grown)
    return coupling.points(state.positions, normals, world.form.layers)


def _windows(world: World, state: State) -> coupling.Windows:
    at = coupling.windows(_points(world, state), world.size, world.form.kernel)
    return coupling.masked(at, there(world, world.form.layers))


def _held(motion: Motion, forced: coupling.Forced, groups: Groups) -> Float[Array, "node"]:
    dtype, layers = motion.target.dtype, len(groups.member) // len(motion.target)
    pressed = groups.per_node((forced.scale < 1).astype(dtype))[::layers]
    return jnp.maximum(pressed, (motion.shortened < 1).astype(dtype))
