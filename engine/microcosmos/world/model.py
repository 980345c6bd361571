"""A world: its parameters, which stay fixed, and its state, which changes."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PyTree

from .. import coupling, fields, filaments, fluid
from ..groups import Groups

Vectors = Float[Array, "node 2"]


@dataclass(frozen=True)
class Form:
    """The form of the coupling, fixed when a program is compiled."""

    projection: Callable = coupling.torque_free
    force_factor: float = 2.0
    theta_feedback: float = 1.0
    forcing_iterations: int = 3
    constraint_iterations: int = 10
    layers: int = 1
    kernel: coupling.Kernel = coupling.ROMA
    magic: Callable = fluid.capped_magic
    fluid: bool = True
    """Without a fluid, only constraints and repulsion move bodies."""

    def __post_init__(self):
        if self.projection is coupling.torque_free and self.theta_feedback == 0:
            raise ValueError(
                "`projection` must not be torque_free where `theta_feedback` is 0: edge angles "
                "that ignore the geometry exert a torque of their own."
            )


class Limits(eqx.Module):
    """Limits that keep random controllers finite, in cells a step; None: no limit."""

    displacement: Float[Array, ""] | None = None
    force: Float[Array, ""] | None = None


class World(eqx.Module):
    """The parameters of a run; array fields can be differentiated."""

    viscosity: Float[Array, ""]
    rods: filaments.Rods
    groups: Groups
    """The body of each node."""
    size: tuple[int, int] = eqx.field(static=True)
    form: Form = eqx.field(static=True, default_factory=Form)
    limits: Limits = Limits()
    layout: filaments.Layout | None = None
    """For shape matching; None: sweeps over the constraints."""
    nu_c: Float[Array, ""] | None = None
    """Viscosity at which actuators have half of their strength; None: full strength."""
    steric: fields.Steric | None = None
    barrier: fields.Barrier | None = None
    """What keeps bodies out of solid cells; None: nothing."""
    energy: fields.Energy | None = None
    surroundings: fluid.Surroundings = fluid.Surroundings()
    present: Bool[Array, "node"] | None = None
    """Nodes that have grown; None: all. The others rest and do nothing; their constraints have
    stiffness 0."""


class State(eqx.Module):
    """The state after a step."""

    populations: fluid.Populations
    positions: Vectors
    angles: Float[Array, "edge"]
    energy: Float[Array, "x y"] | None = None
    collected: Float[Array, "node"] | None = None
    """Energy that each node has taken since the start."""
    memory: PyTree[Array] = None
    """Memory of the controller."""


class Measures(eqx.Module):
    """The measures of a step; XLA drops those that are not used."""

    centre: Float[Array, "2"]
    """The mean unwrapped node position at the end of the step, in cells."""
    positions: Vectors
    """The unwrapped positions of nodes at the end of the step, in cells."""
    rest: filaments.Rest
    """The rest shape of the step."""
    speed: Float[Array, ""]
    """Speed of the fastest fluid anywhere before the step, cells a step."""
    node_speed: Float[Array, ""]
    """Mean speed of the nodes, cells a step."""
    held: Float[Array, ""]
    """Share of nodes whose displacement, or whose body's force, was at its limit."""
    heading: Float[Array, ""]
    """The mean unwrapped angle of the edges, in rad."""
    curvature: Float[Array, "joint"]
    """The angle at each joint over the mean length of its edges, 1/cells; 0 where absent."""
    power: Float[Array, ""]
    """Force on the fluid times velocity, summed over nodes; a cell's mass is 1."""
    force: Float[Array, "group 2"]
    """Force of each body on the fluid."""


def at_rest(world: World, positions: Vectors) -> State:
    """Return a fluid at rest with bodies at `positions`, and the initial energy."""
    planes = tuple(jnp.zeros(world.size, positions.dtype) for _ in range(9))
    angles = filaments.edge_angles(positions, world.rods)
    if world.energy is None:
        return State(planes, positions, angles)
    return State(planes, positions, angles, world.energy.start, jnp.zeros_like(positions[:, 0]))


def with_bodies(world: World, start: State, positions: Vectors) -> State:
    """Return a start with the bodies of `world` at `positions`, in the same fluid."""
    angles = filaments.edge_angles(positions, world.rods)
    collected = None if start.collected is None else jnp.zeros_like(positions[:, 0])
    return replace(start, positions=positions, angles=angles, collected=collected)


def flow(world: World, state: State) -> fluid.Vectors:
    """Return the fluid's velocity in cells per step, without the half step of force."""
    momentum = fluid.momentum(state.populations)
    return jnp.stack(momentum) / fluid.density(state.populations)[None]
