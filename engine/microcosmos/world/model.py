"""A world: its parameters, which stay fixed, its state, and the parts that have grown."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PyTree

from .. import coupling, fields, filaments, fluid
from ..groups import Groups

Vectors = Float[Array, "node 2"]


@dataclass(frozen=True)
class Form:
    """The form of the coupling, fixed when a program is compiled."""

    projection: Callable = coupling.torque_free
    # Guo's scheme adds half of the force to the velocity: twice the forcing reaches the target.
    force_factor: float = 2.0
    theta_feedback: float = 1.0
    # At most 2 % from 20 iterations, measured in docs/physics.md, "Forcing".
    forcing_iterations: int = 3
    # Measured: a worm's stroke is within 4 % of that by 30 sweeps; with 3 a third is lost.
    constraint_iterations: int = 10
    layers: int = 1
    # A narrow delta thickens filaments less: docs/physics.md, "The delta".
    kernel: coupling.Kernel = coupling.ROMA
    magic: Callable = fluid.capped_magic
    fluid: bool = True
    """False: only constraints and repulsion move bodies."""

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
    """Layout for shape matching; None: sweeps over the constraints."""
    nu_c: Float[Array, ""] | None = None
    """Viscosity at which actuators have half of their strength; None: full strength."""
    steric: fields.Steric | None = None
    contact: fields.Contact | None = None
    """Repulsion where bodies meet, pair by pair, instead of `steric`; None: none."""
    barrier: fields.Barrier | None = None
    """Displacements that keep bodies out of solid cells; None: bodies pass through them."""
    energy: fields.Energy | None = None
    food: fields.Food | None = None
    """Energy in whole numbers, which creatures in slots eat, instead of `energy`."""
    surroundings: fluid.Surroundings = fluid.Surroundings()
    present: Bool[Array, "node"] | None = None
    """Nodes that have grown; None: all. The others rest and do nothing; their constraints have
    stiffness 0."""

    order: Int[Array, "group"] | None = None
    """The order in which bodies in exactly one place are parted; None: that of the groups."""

    def __check_init__(self):
        if self.food is not None:
            self._check_food(self.food)
        if self.contact is None:
            return
        if self.steric is not None:
            raise ValueError("a world must have `steric` or `contact`, got both.")
        if min(self.size) < fields.contact.LEAST:
            least = fields.contact.LEAST
            raise ValueError(
                f"`size` must be at least {least} along each axis where bodies meet, "
                f"got {self.size}."
            )

    def _check_food(self, food: fields.Food) -> None:
        if food.carried and not self.form.fluid:
            raise ValueError("`food` must not be `carried` in a world without a fluid.")
        if self.energy is not None:
            raise ValueError("a world must have `energy` or `food`, got both.")
        if food.capacity.shape != self.size:
            raise ValueError(
                f"`food.capacity` must have the shape {self.size} of the world, "
                f"got {food.capacity.shape}."
            )


class State(eqx.Module):
    """The state after a step."""

    populations: fluid.Populations
    positions: Vectors
    """In cells, from the corner of the box that holds the body's anchor."""
    angles: Float[Array, "edge"]
    boxes: Float[Array, "group 2"]
    """Whole boxes between the first box and each body's: exact numbers up to 2²⁴."""
    energy: Float[Array, "x y"] | None = None
    collected: Float[Array, "node"] | None = None
    """Energy that each node has taken since the start."""
    memory: PyTree[Array] = None
    """Memory of the controller."""


class Measures(eqx.Module):
    """The measures of a step; XLA removes the computation of those that are not used."""

    centre: Float[Array, "2"]
    """The mean node position at the end of the step, in cells, from the corner of the box that
    holds the first body's anchor."""
    positions: Vectors
    """The positions of nodes at the end of the step, see `State.positions`."""
    boxes: Float[Array, "group 2"]
    """See `State.boxes`."""
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
    state = State(planes, positions, angles, _first_box(world, positions))
    if world.energy is None:
        return state
    collected = jnp.zeros_like(positions[:, 0])
    return replace(state, energy=world.energy.start, collected=collected)


def with_bodies(world: World, start: State, positions: Vectors) -> State:
    """Return a start with the bodies of `world` at `positions`, in the fluid of `start`."""
    angles = filaments.edge_angles(positions, world.rods)
    collected = None if start.collected is None else jnp.zeros_like(positions[:, 0])
    boxes = _first_box(world, positions)
    return replace(start, positions=positions, angles=angles, boxes=boxes, collected=collected)


def _first_box(world: World, positions: Vectors) -> Float[Array, "group 2"]:
    return jnp.zeros((world.groups.count, 2), positions.dtype)


def flow(world: World, state: State) -> fluid.Vectors:
    """Return the fluid's velocity in cells per step, with the half step of the surroundings'
    force.
    """
    moving = fluid.moving(fluid.momentum(state.populations), world.surroundings)
    return jnp.stack(moving) / fluid.density(state.populations)[None]


def grown_nodes(world: World) -> Bool[Array, "node"]:
    """Return the mask of all nodes that have grown."""
    present = world.present
    return jnp.ones(len(world.groups.member), bool) if present is None else present


def present_points(world: World, layers: int = 1) -> Bool[Array, "point"] | None:
    """Return the mask of the points of grown nodes, `layers` for each node; None: all.

    None, not a mask of ones, keeps masks out of programs of bodies without absent nodes.
    """
    if world.present is None or layers == 1:
        return world.present
    return jnp.repeat(world.present, layers)


def present_edges(world: World) -> Bool[Array, "edge"] | None:
    """Return the mask of edges with both ends; None: all."""
    return None if world.present is None else jnp.all(world.present[world.rods.edges], 1)


def present_joints(world: World) -> Bool[Array, "joint"] | None:
    """Return the mask of joints with both edges; None: all."""
    edges, joints = present_edges(world), world.rods.joints
    return None if edges is None or joints is None else jnp.all(edges[joints], 1)


def grown_rods(rods: filaments.Rods, present: Bool[Array, "node"]) -> filaments.Rods:
    """Return rods whose constraints on absent nodes have stiffness 0."""
    assert rods.joints is not None
    edges = jnp.all(present[rods.edges], 1)
    return replace(
        rods,
        stretch=jnp.where(edges, rods.stretch, 0.0),
        shear=jnp.where(edges, rods.shear, 0.0),
        bend=jnp.where(jnp.all(edges[rods.joints], 1), rods.bend, 0.0),
    )


def mean(values: Float[Array, "item *rest"], kept: Bool[Array, "item"] | None):
    """Return the mean of present items, over the first axis; 0 without any."""
    if kept is None:
        return jnp.mean(values, 0)
    mask = kept.reshape(-1, *(1,) * (values.ndim - 1))
    # Absent items may hold any number: they are masked, not multiplied by 0.
    return jnp.sum(jnp.where(mask, values, 0.0), 0) / jnp.maximum(jnp.sum(kept), 1)


def centre(world: World, state: State) -> Float[Array, "2"]:
    """Return the mean node position in cells, from the corner of the first body's box."""
    if world.groups.count == 1:
        return mean(state.positions, world.present)
    return mean(together(world, state.positions, state.boxes), world.present)


def together(
    world: World,
    positions: Float[Array, "*time node 2"],
    boxes: Float[Array, "*time group 2"],
) -> Float[Array, "*time node 2"]:
    """Return the positions of all nodes in cells, from the corner of the box of the first body
    that has grown."""
    away = boxes - jnp.broadcast_to(leading(world, boxes)[..., None, :], boxes.shape)
    return positions + _per_node(world, _cells(world, away))


def leading(world: World, boxes: Float[Array, "*time group 2"]) -> Float[Array, "*time 2"]:
    """Return the box of the first body of which a node has grown."""
    grown = has_grown(world)
    return boxes[..., 0, :] if grown is None else jnp.take(boxes, jnp.argmax(grown), axis=-2)


def unwrapped(world: World, seen: State | Measures) -> Float[Array, "*time node 2"]:
    """Return the positions of all nodes in cells, from the corner of the first box.

    `seen` are a state, or measures, which may have time first. Rounding grows with the
    distance: a way is better measured with `route`.
    """
    return seen.positions + _per_node(world, _cells(world, seen.boxes))


class Route(eqx.Module):
    """The centre of all nodes before the first step and after each of a simulation."""

    centre: Float[Array, "time 2"]
    """In cells, from the corner of the box of the first body that has grown."""
    cells: Float[Array, "time 2"]
    """From the corner of its box at the start to that of its box, in cells."""

    @property
    def places(self) -> Float[Array, "time 2"]:
        """Centres in cells, from the corner of the first body's box at the start."""
        return self.centre + self.cells

    def way(self, before: Any, after: Any) -> Float[Array, "*times 2"]:
        """Return the ways between two times, or many, without the rounding of far places."""
        return (self.centre[after] - self.centre[before]) + (
            self.cells[after] - self.cells[before]
        )


def route(world: World, start: State, observed: Measures) -> Route:
    """Return the route of a simulation; `observed` has time first."""
    centres = jnp.concatenate([centre(world, start)[None], observed.centre])
    first = leading(world, start.boxes)[None]
    boxes = jnp.concatenate([first, leading(world, observed.boxes)])
    return Route(centres, _cells(world, boxes - jnp.broadcast_to(first, boxes.shape)))


def within_box(world: World, state: State) -> State:
    """Return the same state with each body in the box that holds its anchor, its first node
    that has grown.

    Positions so far from the origin that rounding would swallow a step are never formed.
    """
    places = state.positions[anchors(world)]
    whole = jax.lax.stop_gradient(jnp.floor(places / _cells(world, jnp.ones_like(places))))
    grown = has_grown(world)
    if grown is not None:
        whole = jnp.where(grown[:, None], whole, 0.0)
    positions = state.positions - _per_node(world, _cells(world, whole))
    return replace(state, positions=positions, boxes=state.boxes + whole)


def _cells(world: World, boxes: Float[Array, "*any 2"]) -> Float[Array, "*any 2"]:
    """Return the lengths of whole boxes in cells."""
    return boxes * jnp.broadcast_to(jnp.array(world.size, boxes.dtype), boxes.shape)


def _per_node(
    world: World, values: Float[Array, "*time group 2"]
) -> Float[Array, "*time node 2"]:
    # One body's value is broadcast: an index for each node costs more.
    return values if world.groups.count == 1 else values[..., world.groups.member, :]


def has_grown(world: World) -> Bool[Array, "group"] | None:
    """Return the mask of the bodies of which a node has grown; None: all."""
    if world.present is None:
        return None
    return world.groups.largest(world.present.astype(jnp.int32)) > 0


def anchors(world: World) -> Int[Array, "group"]:
    """Return the first node of each body that has grown; any node where none has."""
    nodes = len(world.groups.member)
    if world.groups.count == 1 and world.present is None:
        return jnp.zeros(1, jnp.int32)
    left = jnp.arange(nodes, 0, -1)
    if world.present is not None:
        left = jnp.where(world.present, left, 1)
    return nodes - world.groups.largest(left)
