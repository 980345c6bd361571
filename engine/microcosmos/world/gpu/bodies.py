"""The body of a world and its exchange with the fluid, in the order of `stepping`.

Nodes are vectors; sums over all pairs of nodes are products of the weights of `coupling` along
both axes, which stand in tables.
"""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
from jax.experimental.pallas import triton

from ... import fluid
from .lattice import addresses
from .plan import Pair, Plan, Ref, difference, divided, repeat, wrapped

ROW = 4
"""Cells along each side of a window, of which the delta may not reach the last."""


def _bases(plan: Plan, position: Pair) -> tuple[Pair, Pair]:
    """Return positions within the box, and the first cell of each window.

    A position that is not finite counts as 0, so that it points into memory.
    """
    inside, bases = [], []
    for x, cells in zip(position, plan.size, strict=True):
        x = x - cells * jnp.floor(x / cells)
        x = jnp.where((x >= 0) & (x <= cells), x, 0.0)
        inside.append(x)
        bases.append(jnp.floor(x - (plan.delta.points / 2 - 1)))
    return tuple(inside), tuple(bases)


def within_box(plan: Plan, position: Pair, anchor) -> tuple[Pair, Pair]:
    """Return positions from the corner of the box that holds the anchor, and how many whole
    boxes that is from the corner before.
    """
    inside, boxes = [], []
    for x, cells in zip(position, plan.size, strict=True):
        whole = jnp.floor(jnp.sum(jnp.where(anchor > 0, x, 0.0)) / cells)
        inside.append(x - cells * whole)
        boxes.append(whole)
    return tuple(inside), tuple(boxes)


def interpolate(plan: Plan, f: Ref, window: Ref, odd, position: Pair, mask) -> Pair:
    """Return the velocity of the fluid at the nodes.

    `window` gets the weights over the density.
    """
    inside, bases = _bases(plan, position)
    lane = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 1)
    node = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 0)

    def read(line, velocity: Pair) -> Pair:
        along_x = plan.delta.weight(inside[0] - (bases[0] + line.astype(f.dtype)))
        along_y = plan.delta.weight(
            inside[1][:, None] - (bases[1][:, None] + lane.astype(f.dtype))
        )
        places = addresses(plan, odd, *_line(plan, bases, line))
        planes = tuple(triton.load(f.at[place]) for place in places)
        weight = (mask * along_x)[:, None] * along_y / fluid.density(planes)
        triton.store(window.at[node, ROW * line + lane], weight)
        x, y = fluid.momentum(planes)
        return velocity[0] + jnp.sum(weight * x, 1), velocity[1] + jnp.sum(weight * y, 1)

    return repeat(plan.delta.points, read, (jnp.zeros_like(mask), jnp.zeros_like(mask)))


def _line(plan: Plan, bases: Pair, line) -> Pair:
    """Return the places of the cells of a line of all windows, (node, lane)."""
    lane = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 1).astype(bases[0].dtype)
    x = wrapped(bases[0] + line.astype(lane.dtype), plan.size[0]).astype(jnp.int32)
    y = wrapped(bases[1][:, None] + lane, plan.size[1]).astype(jnp.int32)
    return jnp.broadcast_to(x[:, None], y.shape), y


def clear(plan: Plan, force: Ref, position: Pair) -> None:
    """Set the force in the cells of all windows to zero."""
    bases = _bases(plan, position)[1]

    def write(line, carry):
        x, y = _line(plan, bases, line)
        cells = x * plan.size[1] + y
        for axis in range(2):
            triton.store(
                force.at[axis * plan.cells + cells], jnp.zeros(cells.shape, force.dtype)
            )
        return carry

    repeat(plan.delta.points, write, 0)


def tabulate(plan: Plan, tables: Ref, position: Pair, mask) -> None:
    """Write, for each axis and line of the windows, the weights of all nodes in that line.

    `tables` is (axis, line, window, node): the weight of a node in the line of a node's window.
    """
    inside, bases = _bases(plan, position)

    def write(axis: int, line, carry):
        cells = plan.size[axis]
        cell = wrapped(bases[axis] + line.astype(mask.dtype), cells)
        away = inside[axis][None, :] - cell[:, None]
        away = away - cells * jnp.floor(away / cells + 0.5)
        tables[axis, line, :, :] = mask[None, :] * plan.delta.weight(away)
        return carry

    for axis in range(2):
        repeat(plan.delta.points, partial(write, axis), 0)


def forced(
    plan: Plan, window: Ref, tables: Ref, position: Pair, mask, velocity, target: Pair, limit
):
    """Return the force on the fluid, the target less its rigid part, and the limiting factor.

    See `coupling.multi_direct_forcing`; J S / ρ is a matrix here.
    """
    node = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes,), 0)

    def add(number, matrix):
        x, y = divided(number, plan.delta.points)
        weight = triton.load(window.at[node, ROW * x + y])
        return matrix + weight[:, None] * (tables[0, x, :, :] * tables[1, y, :, :])

    # Two nodes share cells where their windows do: the sum over the cells of one window gives a
    # row, without a plane of forces between iterations.
    nothing = jnp.zeros((plan.nodes, plan.nodes), mask.dtype)
    matrix = repeat(plan.delta.points**2, add, nothing)
    coverage = jnp.sum(matrix, 1)
    beta = jnp.where(mask > 0, 1.0 / jnp.where(mask > 0, coverage, 1.0), 0.0)
    rigid = _rigid(plan, beta, position)
    q, reached = (jnp.zeros_like(beta),) * 2, (jnp.zeros_like(beta),) * 2
    for number, length in enumerate(plan.lengths):
        if number:
            reached = tuple(jnp.sum(matrix * one[None, :], 1) for one in q)
        error = difference(difference(target, velocity), reached)
        removed = rigid(error)
        q = tuple(
            one + length * beta * (e - r) for one, e, r in zip(q, error, removed, strict=True)
        )
        target = difference(target, removed)
    largest = jnp.sqrt(jnp.max(q[0] * q[0] + q[1] * q[1]) + 1e-24)
    scale = jnp.minimum(1.0, limit / largest)
    return tuple(plan.force_factor * (one * scale) for one in q), target, scale


def _rigid(plan: Plan, beta, position: Pair) -> Callable[[Pair], Pair]:
    """Return the function that finds the rigid part of errors, see `coupling.torque_free`."""
    total = jnp.sum(beta)
    x, y = (one - jnp.sum(beta * one) / total for one in position)
    inertia = jnp.sum(beta * (x * x + y * y))

    def rigid(error: Pair) -> Pair:
        moved = tuple(jnp.sum(beta * one) / total for one in error)
        left = difference(error, moved)
        if not plan.turns:
            return tuple(jnp.broadcast_to(one, beta.shape) for one in moved)
        spin = jnp.sum(beta * (x * left[1] - y * left[0])) / inertia
        return moved[0] - spin * y, moved[1] + spin * x

    return rigid


def spread(plan: Plan, force: Ref, tables: Ref, position: Pair, forcing: Pair) -> None:
    """Write the force in the cells of all windows.

    Each window has the whole sum over nodes, so that windows that share a cell agree.
    """
    bases = _bases(plan, position)[1]

    def write(number, carry):
        lines = divided(number, plan.delta.points)
        x, y = (
            wrapped(base + line.astype(base.dtype), cells).astype(jnp.int32)
            for base, line, cells in zip(bases, lines, plan.size, strict=True)
        )
        weight = tables[0, lines[0], :, :] * tables[1, lines[1], :, :]
        for axis in range(2):
            total = jnp.sum(weight * forcing[axis][None, :], 1)
            triton.store(force.at[axis * plan.cells + x * plan.size[1] + y], total)
        return carry

    repeat(plan.delta.points**2, write, 0)


def fitted(shape: Pair, position: Pair, mask, count) -> Pair:
    """Return a rest shape about its middle, moved and turned to be nearest to positions."""
    centre = tuple(jnp.sum(mask * one) / count for one in position)
    arm, (x, y) = difference(position, centre), shape
    cosine = jnp.sum(mask * (x * arm[0] + y * arm[1]))
    sine = jnp.sum(mask * (x * arm[1] - y * arm[0]))
    size = jnp.sqrt(cosine * cosine + sine * sine + 1e-24)
    c, s = cosine / size, sine / size
    return centre[0] + (c * x - s * y), centre[1] + (s * x + c * y)


def limited(moved: Pair, limit):
    """Return displacements of at most `limit`, their lengths, and 1 where it acts."""
    speed = jnp.sqrt(moved[0] * moved[0] + moved[1] * moved[1] + 1e-24)
    factor = jnp.minimum(1.0, limit / speed)
    x, y = moved[0] * factor, moved[1] * factor
    held = jnp.where(factor < 1, 1.0, 0.0)
    return (x, y), jnp.sqrt(x * x + y * y + 1e-24), held
