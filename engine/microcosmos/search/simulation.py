"""Simulation of an actuator, or of a school: by the native kernel where it can, else by JAX.

A school is copies of one creature in one fluid, with one clock.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from ..filaments import Layout, Pairing, Rest, Rings, Rods
from ..genomes import Drive, carried_out
from ..groups import Groups
from ..portable import cosine, sine
from ..world import Measures, State, World, follow, gpu, keep_memory, native, rollout
from .measures import observe
from .task import Actuator, Task

Places = Float[Array, "copy 2"]


def schooled(driven: Drive, places: Places) -> Drive:
    """Return the simulation of copies of a creature, each moved by its place.

    Nodes, edges and joints stand copy by copy. Each copy carries out the rest shapes of the
    first, which a controller commands from the first copy's state.
    """
    world, start, copies = driven.world, driven.start, len(places)
    nodes, edges = len(start.positions), len(start.angles)

    def first(state: State) -> State:
        return replace(
            state,
            positions=state.positions[:nodes],
            angles=state.angles[:edges],
            boxes=state.boxes[: world.groups.count],
        )

    def control(_: World, state: State, given: Any) -> Rest:
        return _repeated(driven.control(world, first(state), given), copies, axis=0)

    def remember(_: World, state: State, given: Any) -> Any:
        return driven.remember(world, first(state), given)

    school = replace(driven, world=_world(world, copies), start=_start(start, places))
    # The kernel knows no controllers of schools, but it can simulate rest shapes in open loop,
    # whatever commands them.
    if driven.control is follow and driven.remember is keep_memory:
        return replace(school, inputs=_repeated(driven.inputs, copies, axis=1), controller=None)
    return replace(school, control=control, remember=remember, controller=None)


def _repeated(tree: Any, copies: int, axis: int) -> Any:
    return jax.tree.map(lambda x: jnp.concatenate([x] * copies, axis), tree)


def _start(start: State, places: Places) -> State:
    copies = len(places)
    positions = jnp.concatenate([start.positions + place[None] for place in places])
    return replace(
        start,
        positions=positions,
        angles=jnp.tile(start.angles, copies),
        boxes=jnp.tile(start.boxes, (copies, 1)),
        collected=None if start.collected is None else jnp.tile(start.collected, copies),
    )


def _world(world: World, copies: int) -> World:
    return replace(
        world,
        rods=_rods(world.rods, len(world.groups.member), copies),
        groups=_groups(world.groups, copies),
        layout=None if world.layout is None else _layout(world.layout, copies),
        present=None if world.present is None else jnp.tile(world.present, copies),
    )


def _groups(groups: Groups, copies: int) -> Groups:
    member = _numbers(groups.member, groups.count, copies)
    return Groups(member, copies * groups.count, groups.ascending)


def _numbers(numbers: Array, count: int, copies: int) -> Array:
    """Return numbers below `count`, those of each copy after those of the one before."""
    return jnp.concatenate([numbers + copy * count for copy in range(copies)])


def _rods(rods: Rods, nodes: int, copies: int) -> Rods:
    edges, joints = len(rods.edges), len(rods.bend)

    def colours(pairings: tuple[Pairing, ...], members: int, count: int) -> tuple[Pairing, ...]:
        if not pairings or len(pairings[0].partner) < members:
            return pairings  # They are those of every chunk of equal bodies.
        return tuple(
            Pairing(
                _numbers(one.partner, members, copies),
                _numbers(one.constraint, count, copies),
                jnp.tile(one.sign, copies),
            )
            for one in pairings
        )

    stiffness = {
        name: jnp.tile(getattr(rods, name), copies) for name in ("stretch", "shear", "bend")
    }
    return replace(
        rods,
        edges=_numbers(rods.edges, nodes, copies),
        edge_colours=colours(rods.edge_colours, nodes, edges),
        joint_colours=colours(rods.joint_colours, edges, joints),
        joints=None if rods.joints is None else _numbers(rods.joints, edges, copies),
        rings=None if rods.rings is None else _rings(rods.rings, copies),
        **stiffness,
    )


def _rings(rings: Rings, copies: int) -> Rings:
    count, none = rings.count, jnp.asarray(copies * rings.count)
    of = jnp.tile(rings.of < count, copies)
    of = jnp.where(of, _numbers(rings.of, count, copies), none)
    return Rings(
        of.astype(rings.of.dtype),
        jnp.tile(rings.sign, copies),
        jnp.tile(rings.whole, copies),
        copies * count,
    )


def _layout(layout: Layout, copies: int) -> Layout:
    each = jnp.eye(copies, dtype=layout.turned.dtype)
    pieces = layout.pieces
    return Layout(
        angle=jnp.tile(layout.angle, copies),
        rest_angle=jnp.tile(layout.rest_angle, copies),
        turned=jnp.kron(each, layout.turned),
        placed=jnp.kron(each, layout.placed),
        pieces=Groups(
            _numbers(pieces.member, pieces.count, copies),
            copies * pieces.count,
            pieces.ascending,
        ),
        bend=None if layout.bend is None else jnp.tile(layout.bend, copies),
        bends=None if layout.bends is None else jnp.tile(layout.bends, copies),
    )


def shift_energy(driven: Drive, shift: Int[Array, "2"]) -> Drive:
    """Return the simulation with the energy moved by `shift` cells."""
    assert driven.start.energy is not None
    energy = jnp.roll(driven.start.energy, shift, (0, 1))
    return replace(driven, start=replace(driven.start, energy=energy))


def drive(task: Task, actuator: Actuator, *, differentiable: bool = False) -> Drive:
    """Return the simulation of a genotype, or of a body that follows rest shapes, and of all
    its copies.

    The native kernel develops what it can, unless the result has to be `differentiable`.
    """
    driven = _alone(task, actuator, differentiable)
    return driven if task.places is None else schooled(driven, task.places)


def _alone(task: Task, actuator: Actuator, differentiable: bool) -> Drive:
    if isinstance(actuator, Rest) or task.encoding is None:
        return Drive(task.world, task.start, actuator)
    driven = task.encoding.drive(task.world, task.start, actuator, task.phase)
    if task.actuators is not None:
        own = (
            task.actuators
            if driven.layout is None
            else replace(task.actuators, layout=driven.layout)
        )
        driven = carried_out(driven, own)
    if not differentiable:
        driven = _developed(driven)
    if task.turn is None:
        return driven
    return replace(driven, start=turned(driven.start, task.turn))


def _developed(driven: Drive) -> Drive:
    """Return the simulation with rest shapes of the native kernel, if it simulates that."""
    world, start, controller = driven.world, driven.start, driven.controller
    if controller is None or controller.senses or not native.chosen(world, start):
        return driven
    # In JAX the development of a creature of `standard` took 4.0 ms, here 1.0 ms
    # (docs/physics.md).
    rest, clock = native.develop(world, start, controller)
    return replace(driven, inputs=rest, clock=clock)


def turned(state: State, turn: Float[Array, ""]) -> State:
    """Return the state with the bodies turned about the mean of all nodes, in rad."""
    c, s = cosine(turn), sine(turn)
    middle = jnp.mean(state.positions, 0)
    x, y = (state.positions - middle[None]).T
    positions = jnp.stack([c * x - s * y, s * x + c * y], 1) + middle[None]
    return replace(state, positions=positions, angles=state.angles + turn)


def simulate(
    driven: Drive,
    observer: Callable[[State, Measures], Any] = observe,
    segment: int | None = None,
    *,
    differentiable: bool = False,
) -> tuple[State, Any]:
    """Return the state at the end, and the observations after each step.

    A kernel simulates what it can, unless the result has to be `differentiable`.
    """
    # The kernels record what `observe` returns and keep nothing for derivatives.
    plain = observer is observe and segment is None and not differentiable
    given = given_of(driven)
    if plain and is_native(driven):
        return native.rollout(driven.world, driven.start, given)
    if plain and isinstance(given, Rest) and gpu.chosen(driven.world, driven.start):
        return gpu.rollout(driven.world, driven.start, given)
    go_on = partial(rollout, control=driven.control, remember=driven.remember, segment=segment)
    return go_on(driven.world, driven.start, driven.inputs, observer)


def is_native(driven: Drive) -> bool:
    """Return whether the native kernel simulates this; see `native.chosen`."""
    return native.chosen(driven.world, driven.start, given_of(driven) is not None)


def given_of(driven: Drive) -> Any:
    """Return rest shapes, or in closed loop the controller; None if only JAX knows it."""
    open_loop = driven.control is follow and driven.remember is keep_memory
    return driven.inputs if open_loop else driven.controller


def strokes(driven: Drive, period: float | None, steps: int) -> Float[Array, "time"]:
    """Return the strokes done at the end of each of the first steps; 0 without a period."""
    clock = clock_of(driven, steps)
    return jnp.zeros_like(clock) if period is None else clock / period


def clock_of(driven: Drive, steps: int) -> Float[Array, "time"]:
    """Return the controller's time at the end of each of the first steps."""
    return jnp.arange(1.0, steps + 1) if driven.clock is None else driven.clock[:steps]
