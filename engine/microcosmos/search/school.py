"""Schools: copies of one creature in one fluid, with one clock."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..filaments import Layout, Pairing, Rest, Rods
from ..genomes import Drive
from ..groups import Groups
from ..world import State, World, follow, keep_memory

Places = Float[Array, "copy 2"]


def schooled(driven: Drive, places: Places) -> Drive:
    """Return the simulation of copies of a creature, each moved by its place.

    Nodes, edges and joints stand copy by copy. Each copy carries out the rest shapes of the
    first, which a controller commands from the first copy's state.
    """
    world, start, copies = driven.world, driven.start, len(places)
    nodes, edges = len(start.positions), len(start.angles)

    def first(state: State) -> State:
        return replace(state, positions=state.positions[:nodes], angles=state.angles[:edges])

    def control(_: World, state: State, given: Any) -> Rest:
        return _repeated(driven.control(world, first(state), given), copies, axis=0)

    def remember(_: World, state: State, given: Any) -> Any:
        return driven.remember(world, first(state), given)

    school = replace(driven, world=_world(world, copies), start=_start(start, places))
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

    def colours(found: tuple[Pairing, ...], members: int, count: int) -> tuple[Pairing, ...]:
        if not found or len(found[0].partner) < members:
            return found  # They are those of every chunk of equal bodies.
        return tuple(
            Pairing(
                _numbers(one.partner, members, copies),
                _numbers(one.constraint, count, copies),
                jnp.tile(one.sign, copies),
            )
            for one in found
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
        **stiffness,
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
    )
