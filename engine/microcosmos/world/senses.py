"""Senses of nodes: for energy, water and other bodies around them."""

from dataclasses import replace

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .. import coupling, filaments, fluid
from .controller import SENSES
from .model import State, World, anchors, grown_nodes, present_edges
from .nodes import others
from .stepping import windows

ASIDE = 2.0
"""Distance from a node, in cells, at which it senses the energy beside the body."""
LEAST = 1e-4
"""Square of the sum of edges' normals below which a node has no sides: in the middle of a star
rounding would choose them."""
STREAM = 20.0
"""Sensed per cell a step of water: 1 at the largest speed of a flow that a spec allows."""


class Stock(eqx.Module):
    """What creatures sense of a world's quanta."""

    energy: Float[Array, "x y"]
    """1 in a cell with `Food.unit` quanta."""
    account: Float[Array, "group"]
    """1 for a creature with `Food.full` quanta."""


def sensed(
    world: World, state: State, senses: tuple[str, ...], stock: Stock | None = None
) -> Float[Array, "sense node"]:
    """Return what each node senses: one row for each of `senses`, in the order of `SENSES`.

    - `energy`: the energy at the node;
    - `energy_across`: how much more there is 2 cells to the left of the body than to the right,
      seen from its first node to its last;
    - `energy_along`: how much more there is at the first node that has grown than at the last;
    - `flow_along` and `flow_across`: speed of the water towards the last node and to the left,
      less that of the body's nodes together, 1 at 0.05 cells a step;
    - `touch`: the density of other bodies, in nodes a cell; 0 in a world without `contact`;
    - `account`: quanta of the creature, 1 with `Food.full` of them.

    Raises `ValueError` for senses that are unknown, out of order, or for what the world lacks.
    """
    _check(state, senses, stock)
    if stock is not None:
        state = replace(state, energy=stock.energy)
    rows = []
    if "energy" in senses:
        energy = coupling.interpolate((_energy(state),), windows(world, state))
        rows.append(_at_nodes(jnp.tile(energy, (1, 2)), world)[:, 0])
    across = filaments.normals(
        state.angles, world.rods, len(state.positions), present_edges(world), LEAST
    )
    if "energy_across" in senses:
        left, right = (
            _read(world, state, state.positions + side * ASIDE * across) for side in (1, -1)
        )
        rows.append(left - right)
    if "energy_along" in senses:
        ends = [
            _read(world, state, state.positions[one]) for one in (anchors(world), _last(world))
        ]
        rows.append(world.groups.per_node(ends[0] - ends[1]))
    if {"flow_along", "flow_across"} & set(senses):
        water = STREAM * _water(world, state)
        along = jnp.stack([across[:, 1], -across[:, 0]], 1)
        for name, way in (("flow_along", along), ("flow_across", across)):
            if name in senses:
                rows.append(jnp.sum(water * way, 1))
    if "touch" in senses:
        rows.append(others(world, state.positions))
    if "account" in senses:
        assert stock is not None
        rows.append(world.groups.per_node(stock.account))
    return jnp.stack(rows) if rows else jnp.zeros((0, len(state.positions)), state.angles.dtype)


def _check(state: State, senses: tuple[str, ...], stock: Stock | None) -> None:
    if senses != tuple(one for one in SENSES if one in senses):
        raise ValueError(
            f"`senses` must be of {', '.join(SENSES)}, in this order, got {senses}."
        )
    if stock is None and "account" in senses:
        raise ValueError("`senses` must not have account in a world without food.")
    if stock is None and state.energy is None:
        for one in senses:
            if one.startswith("energy"):
                raise ValueError(
                    f"`senses` must not have {one} in a world without energy and food."
                )


def _water(world: World, state: State) -> Float[Array, "node 2"]:
    """Return the velocity of the fluid at nodes, less its mean over the body."""
    rho, momentum = fluid.density(state.populations), fluid.momentum(state.populations)
    moving = fluid.moving(momentum, world.surroundings)
    at = coupling.divided(windows(world, state), rho)
    velocity = _at_nodes(coupling.interpolate(moving, at), world)
    groups, weights = world.groups, grown_nodes(world).astype(velocity.dtype)
    return velocity - groups.per_node(groups.mean(velocity, weights))


def _at_nodes(values: Float[Array, "point 2"], world: World) -> Float[Array, "node 2"]:
    return coupling.at_nodes(values, world.form.layers)


def _energy(state: State) -> Float[Array, "x y"]:
    assert state.energy is not None
    return state.energy


def _read(world: World, state: State, places: Float[Array, "place 2"]) -> Float[Array, "place"]:
    at = coupling.windows(places, world.size, coupling.HAT)
    return coupling.interpolate((_energy(state),), at)[:, 0]


def _last(world: World):
    """Return the last node of each body that has grown."""
    number = jnp.arange(len(world.groups.member))
    return world.groups.largest(jnp.where(grown_nodes(world), number, 0))
