"""Actuators with finite means: bounds on the bend, the pace and the response of a body.

A controller commands rest shapes. Its actuators carry them out: bent less where the body would
close on itself, no faster than they can move a node, and with a lag, which bounds the
acceleration and so the force on the fluid. In open loop the clock slows where the commanded
shape is too fast, so that a gait keeps its shapes and takes longer; in closed loop the present
shape follows the command at the bounded speed.
"""

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PyTree

from ..filaments import Layout, Rest, fitted, rest_positions, standing, turns
from ..world import Actuators, State, World, present_edges
from .encoding import Drive, Scalar


class Response(eqx.Module):
    """Memory of the actuators in closed loop."""

    controller: PyTree[Array]
    paced: Rest
    """Command after the bound on speed."""
    rest: Rest
    """Rest shape after the lag."""


def carried_out(driven: Drive, actuators: Actuators) -> Drive:
    """Return the simulation in which actuators carry out the controller's commands."""
    if driven.controller is not None:
        driven = replace(driven, controller=replace(driven.controller, actuators=actuators))
    if isinstance(driven.inputs, Rest):
        return _open_loop(driven, actuators)
    return _closed_loop(driven, actuators)


def _open_loop(driven: Drive, actuators: Actuators) -> Drive:
    commands = bounded(driven.inputs, actuators, driven.world)
    # The first command, at time 0, is the shape in which the body stands.
    start = shape_of(driven.start, driven.world, actuators.layout)
    commands = jax.tree.map(lambda x, y: jnp.concatenate([x[None], y]), start, commands)
    present = driven.world.present
    steps = jnp.arange(1, len(commands.angle), dtype=commands.angle.dtype)
    at = steps
    if actuators.max_speed is not None:
        at = clock(speeds(commands, actuators.layout, present), actuators.max_speed)
    index = jnp.clip(jnp.floor(at).astype(jnp.int32), 0, len(steps) - 1)
    share = (at - index)[:, None]
    paced = jax.tree.map(lambda x: x[index] * (1 - share) + x[index + 1] * share, commands)
    return replace(driven, inputs=lagged(start, paced, actuators.lag), clock=at)


def _closed_loop(driven: Drive, actuators: Actuators) -> Drive:
    begun = shape_of(driven.start, driven.world, actuators.layout)

    def remember(world: World, state: State, given: Any) -> Response:
        # The controller sees its own memory alone, as it does without actuators.
        memory = state.memory
        state = replace(state, memory=memory.controller)
        state = replace(state, memory=driven.remember(world, state, given))
        command = bounded(driven.control(world, state, given), actuators, world)
        speed, layout = actuators.max_speed, actuators.layout
        paced = command
        if speed is not None:
            paced = towards(memory.paced, command, layout, speed, world.present)
        rest = between(memory.rest, paced, 1 / (1 + actuators.lag))
        return Response(state.memory, paced, rest)

    def control(world: World, state: State, given: Any) -> Rest:
        return state.memory.rest

    start = replace(driven.start, memory=Response(driven.start.memory, begun, begun))
    return replace(driven, start=start, control=control, remember=remember)


def towards(
    paced: Rest,
    command: Rest,
    layout: Layout,
    max_speed: Scalar | float,
    present: Bool[Array, "node"] | None,
) -> Rest:
    """Return the shape after a step towards a command, at most so many cells of the fastest
    node."""
    before, after = (rest_positions(one, layout) for one in (paced, command))
    fast = fastest(before, after, layout, present)
    return between(paced, command, jnp.minimum(1.0, max_speed / fast))


def shape_of(state: State, world: World, layout: Layout) -> Rest:
    """Return the rest shape in which the body stands; angles near the layout's rest angles."""
    return standing(state.positions, state.angles, world.rods, layout)


def bounded(rest: Rest, actuators: Actuators, world: World) -> Rest:
    """Return rest shapes whose bend, relative to the body at rest, is within the bound."""
    if actuators.max_bend is None:
        return rest
    return bent(rest, actuators.layout, actuators.max_bend, present_edges(world))


def bent(
    rest: Rest, layout: Layout, most: Scalar | float, present: Bool[Array, "edge"] | None
) -> Rest:
    """Return rest shapes in which any two edges turn apart by at most `most`, in rad."""
    turned = turns(rest, layout)
    if present is not None:
        # Absent edges turn with the first, which every grown body has: they widen no span.
        present = jnp.broadcast_to(present, turned.shape)
        turned = jnp.where(present, turned, turned[..., :1])
    span = jnp.max(turned, -1) - jnp.min(turned, -1)
    # A body at rest has no span: the least one keeps quotient and gradient finite.
    share = jnp.minimum(1.0, most / jnp.maximum(span, 1e-6))[..., None]
    straight = jnp.broadcast_to(layout.rest_angle, rest.angle.shape)
    return Rest(straight + share * (rest.angle - straight), rest.length)


def fastest(
    before: Float[Array, "node 2"],
    after: Float[Array, "node 2"],
    layout: Layout,
    present: Bool[Array, "node"] | None,
) -> Float[Array, ""]:
    """Return the largest displacement of a node between two shapes, less rigid motion."""
    moved = fitted(after, before, layout.pieces, present) - before
    squares = jnp.sum(moved * moved, 1)
    if present is not None:
        squares = jnp.where(present, squares, 0.0)
    # The constant keeps the root, and quotients by it, finite for a body that does not move.
    return jnp.sqrt(jnp.max(squares) + 1e-20)


def speeds(
    rest: Rest, layout: Layout, present: Bool[Array, "node"] | None
) -> Float[Array, "time"]:
    """Return the speed of the fastest node from each rest shape to the next."""
    shapes = rest_positions(rest, layout)
    return jax.vmap(lambda a, b: fastest(a, b, layout, present))(shapes[:-1], shapes[1:])


def clock(speeds: Float[Array, "time"], max_speed: float) -> Float[Array, "time"]:
    """Return the time of the commands at the end of each step, 1 a step or slower."""
    took = jnp.cumsum(jnp.maximum(1.0, speeds / max_speed))
    took = jnp.concatenate([jnp.zeros(1, took.dtype), took])
    times = jnp.arange(len(took), dtype=took.dtype)
    return jnp.interp(times[1:], took, times)


def lagged(start: Rest, commands: Rest, lag: float) -> Rest:
    """Return the first-order response to commands, with the time constant `lag` in steps."""
    if not lag:
        return commands

    def follow(rest, command):
        rest = between(rest, command, 1 / (1 + lag))
        return rest, rest

    # Written out in part: on a GPU each round of a loop costs more than the arithmetic.
    return jax.lax.scan(follow, start, commands, unroll=20)[1]


def between(one: Rest, other: Rest, share: Any) -> Rest:
    """Return the shape by a share of the way from one to another."""
    return jax.tree.map(lambda x, y: x + share * (y - x), one, other)
