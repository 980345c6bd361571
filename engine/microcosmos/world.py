"""One world: a periodic box of viscous fluid with a body in it, in lattice units."""

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from . import coupling, filaments, fluid


@dataclass(frozen=True)
class Form:
    """How body and fluid act on each other; fixed when a program is compiled."""

    projection: Callable = coupling.torque_free
    force_factor: float = 2.0
    theta_feedback: float = 1.0
    forcing_iterations: int = 3
    constraint_iterations: int = 10
    displacement_limit: float | None = None
    force_limit: float | None = None
    magic: Callable = fluid.capped_magic

    def __post_init__(self):
        if self.projection is coupling.torque_free and self.theta_feedback == 0:
            raise ValueError(
                "`projection` must not be torque_free where `theta_feedback` is 0: edge angles "
                "that ignore the geometry exert a torque of their own."
            )


class World(eqx.Module):
    """What stays fixed during a run; array fields can be differentiated."""

    viscosity: Float[Array, ""]
    rods: filaments.Rods
    size: tuple[int, int] = eqx.field(static=True)
    form: Form = eqx.field(static=True)


class State(eqx.Module):
    """What changes at every step."""

    populations: fluid.Populations
    positions: Float[Array, "node 2"]
    angles: Float[Array, "edge"]


class Motion(eqx.Module):
    """The body on its way through a step: before the fluid's answer."""

    velocity: Float[Array, "node 2"]
    target: Float[Array, "node 2"]
    angles: Float[Array, "edge"]


def at_rest(world: World, positions: Float[Array, "node 2"]) -> State:
    """A fluid at rest with a body at `positions`."""
    planes = tuple(jnp.zeros(world.size, positions.dtype) for _ in range(9))
    return State(planes, positions, filaments.edge_angles(positions, world.rods))


def step(world: World, state: State, rest: filaments.Rest) -> State:
    """One step: the fluid carries the body, constraints move it, the fluid answers."""
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    at = coupling.windows(state.positions, world.size)
    motion = move(world, state, rest, _interpolate(momentum, rho, at))
    forced = coupling.multi_direct_forcing(
        motion.velocity,
        motion.target,
        state.positions,
        rho,
        at,
        iterations=world.form.forcing_iterations,
        projection=world.form.projection,
        limit=world.form.force_limit,
    )
    force = world.form.force_factor * coupling.spread(forced.forcing, at, world.size)
    rates = fluid.rates(world.viscosity, world.form.magic)
    populations = fluid.stream(fluid.collide(state.populations, rho, momentum, force, rates))
    return State(populations, state.positions + forced.target, motion.angles)


def move(
    world: World, state: State, rest: filaments.Rest, velocity: Float[Array, "node 2"]
) -> Motion:
    """Carry the body with the fluid, project it onto its constraints, limit its speed."""
    positions = state.positions + velocity
    followed = filaments.follow_geometry(state.angles, positions, world.rods)
    angles = state.angles + world.form.theta_feedback * (followed - state.angles)
    positions, angles = filaments.project(
        positions, angles, world.rods, rest, iterations=world.form.constraint_iterations
    )
    target = positions - state.positions
    limit = world.form.displacement_limit
    if limit is not None:
        speed = jnp.sqrt(jnp.sum(target * target, 1, keepdims=True) + 1e-24)
        target = target * jnp.minimum(1.0, limit / speed)
    return Motion(velocity, target, angles)


def rollout(
    world: World,
    state: State,
    rest: filaments.Rest,
    observe: Callable[[State], PyTree[Array]] = lambda state: None,
) -> tuple[State, PyTree[Array]]:
    """The state after all steps of `rest` (time first), and what was observed after each."""

    def advance(state, rest):
        state = step(world, state, rest)
        return state, observe(state)

    return jax.lax.scan(advance, state, rest)


def flow(world: World, state: State) -> fluid.Vectors:
    """The fluid's velocity in cells a step, without the half step of force."""
    momentum = fluid.momentum(state.populations)
    return jnp.stack(momentum) / fluid.density(state.populations)[None]


def _interpolate(momentum, rho, at: coupling.Windows) -> Float[Array, "node 2"]:
    """J u* with u* = m / ρ, formed in the windows alone."""
    weights = at.weights / coupling.read(rho, at)
    return jnp.stack([jnp.sum(weights * coupling.read(m, at), (1, 2)) for m in momentum], 1)
