"""A whole rollout in one program per world, written in Pallas for Triton, for GPUs.

A program takes the steps of `stepping` in the same order, with vectors of nodes in registers and
the fluid in the near memory of the chip. Nothing depends on the order in which threads write:
a cell that several windows share receives the same sum from each.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax.experimental import pallas
from jax.experimental.pallas import triton
from jaxtyping import Array

from .. import coupling, fluid

TILE, WARPS = 1024, 8
"""Cells that a program collides at once, and its groups of 32 threads."""
ROW = 4
"""Cells along each side of a window, of which the delta may not reach the last."""
RATES = ("even", "odd", "displacement", "force")
"""Relaxation rates and limits, in the order of the operand."""
OBSERVED = ("speed", "node_speed", "held", "power", "force_x", "force_y")
"""Numbers that a step returns beside positions."""

Pair = tuple[Any, Any]
"""A value along x and one along y; of nodes (node,), in a matrix (node, other node)."""
Ref = Any


@dataclass(frozen=True)
class Plan:
    """What is fixed when a program is compiled."""

    size: tuple[int, int]
    steps: int
    nodes: int
    """Nodes, filled up to a power of two."""
    delta: coupling.Kernel
    lengths: tuple[float, ...]
    """Step lengths of the forcing iterations."""
    turns: bool
    """Whether the projection removes the rotation too."""
    force_factor: float
    interpreted: bool

    @property
    def cells(self) -> int:
        return self.size[0] * self.size[1]


def rollout(plan: Plan, operands: Sequence[Array]) -> list[Array]:
    """Return populations, positions, positions before the limit, and numbers of each step.

    Operands are the populations, positions (axis, node), 1 for present nodes, rest shapes
    (time, axis, node), and `RATES`. Results but the populations, of which the last two steps are
    returned, have time first.
    """
    shapes = [
        (2 * 9 * plan.cells,),
        (2 * plan.cells,),
        (plan.nodes, ROW * ROW),
        (2, plan.delta.points, plan.nodes, plan.nodes),
        (plan.steps, 2, plan.nodes),
        (plan.steps, 2, plan.nodes),
        (plan.steps, len(OBSERVED)),
    ]
    call = pallas.pallas_call(
        partial(_rollout, plan),
        out_shape=[jax.ShapeDtypeStruct(shape, operands[0].dtype) for shape in shapes],
        compiler_params=triton.CompilerParams(num_warps=WARPS, num_stages=1),
        interpret=plan.interpreted,
        name="microcosmos_rollout",
    )
    f, _, _, _, *found = call(*operands)
    return [f.reshape(2, 9, plan.cells), *found]


def _rollout(plan: Plan, start, placed, present, shapes, numbers, f, force, window, tables, *out):
    """Carry one world through all steps; arguments after the plan are memory."""
    rates = fluid.Rates(numbers[0], numbers[1])
    there = present[:]
    count = jnp.sum(there)
    _prepare(plan, start, f, force)

    def step(time, position: Pair) -> Pair:
        now = _divided(time, 2)[1]
        velocity = _interpolate(plan, f, window, now, position, there)
        _tabulate(plan, tables, position, there)
        _wait(plan)
        shape = shapes[time, 0, :], shapes[time, 1, :]
        fitted = _fitted(shape, _sum(position, velocity), there, count)
        wanted, speed, held = _limited(_difference(fitted, position), numbers[2])
        forcing, target, scale = _forced(
            plan, window, tables, position, there, velocity, wanted, numbers[3]
        )
        _spread(plan, force, tables, position, forcing)
        _wait(plan)
        fastest = _flow(plan, f, force, now, rates)
        _wait(plan)
        _clear(plan, force, position)
        _wait(plan)
        position = _sum(position, (there * target[0], there * target[1]))
        held = jnp.where(scale < 1, there, held)
        power = forcing[0] * target[0] + forcing[1] * target[1]
        means = jnp.sum(there * speed) / count, jnp.sum(there * held) / count
        pushed = jnp.sum(power), jnp.sum(forcing[0]), jnp.sum(forcing[1])
        _record(out, time, position, fitted, (fastest, *means, *pushed))
        return position

    _repeat(plan.steps, step, (placed[0, :], placed[1, :]))


def _repeat(times: int, work: Callable, carry: Any) -> Any:
    """Return what `work` makes of `carry` after all times; written out, it needs more registers."""
    return jax.lax.fori_loop(0, times, work, carry)


def _record(out: tuple[Ref, ...], time, position: Pair, fitted: Pair, values: tuple) -> None:
    path, matched, observed = out
    for axis in range(2):
        path[time, axis, :] = position[axis]
        matched[time, axis, :] = fitted[axis]
    for number, value in enumerate(values):
        observed[time, number] = value


def _prepare(plan: Plan, start: Ref, f: Ref, force: Ref) -> None:
    """Copy the first populations, and clear the force."""

    def copy(number, carry):
        at, inside = _cells(plan, number)
        for i in range(9):
            values = triton.load(start.at[i, at], mask=inside, other=_other(inside))
            triton.store(f.at[i * plan.cells + at], values, mask=inside)
        for axis in range(2):
            triton.store(force.at[axis * plan.cells + at], jnp.zeros(at.shape, f.dtype), mask=inside)
        return carry

    _repeat(-(-plan.cells // TILE), copy, 0)
    _wait(plan)


def _cells(plan: Plan, number):
    """Return the numbers of the cells of a tile, and which of them there are; None: all."""
    at = number * TILE + jax.lax.broadcasted_iota(jnp.int32, (1, TILE), 1)
    return at, at < plan.cells if plan.cells % TILE else None


def _other(inside) -> float | None:
    return None if inside is None else 0.0


def _flow(plan: Plan, f: Ref, force: Ref, now, rates: fluid.Rates):
    """Collide and stream all cells; return the speed of the fastest fluid before."""

    def collide(number, fastest):
        at, inside = _cells(plan, number)
        other = _other(inside)
        planes = tuple(
            triton.load(f.at[(now * 9 + i) * plan.cells + at], mask=inside, other=other) for i in range(9)
        )
        pushed = tuple(
            triton.load(force.at[axis * plan.cells + at], mask=inside, other=other) for axis in range(2)
        )
        rho, momentum = fluid.density(planes), fluid.momentum(planes)
        collided = fluid.collide(planes, rho, momentum, pushed, rates)
        x, y = _divided(at, plan.size[1])
        for i, (dx, dy) in enumerate(fluid.DIRECTIONS):
            to = _wrapped(x + dx, plan.size[0]) * plan.size[1] + _wrapped(y + dy, plan.size[1])
            triton.store(f.at[((1 - now) * 9 + i) * plan.cells + to], collided[i], mask=inside)
        square = momentum[0] * momentum[0] + momentum[1] * momentum[1]
        return jnp.maximum(fastest, square / (rho * rho))

    still = jnp.zeros((1, TILE), f.dtype)
    fastest = _repeat(-(-plan.cells // TILE), collide, still)
    return jnp.sqrt(jnp.max(fastest) + 1e-24)


def _divided(number, by: int) -> Pair:
    """Return quotient and remainder of numbers that are not negative."""
    by = jnp.asarray(by, number.dtype)
    return jax.lax.div(number, by), jax.lax.rem(number, by)


def _wrapped(cell, cells: int):
    """Return a number or a coordinate within the box from one at most a box away."""
    cell = jnp.where(cell < 0, cell + cells, cell)
    return jnp.where(cell >= cells, cell - cells, cell)


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


def _interpolate(plan: Plan, f: Ref, window: Ref, now, position: Pair, there) -> Pair:
    """Return the velocity of the fluid at the nodes.

    `window` gets the weights over the density.
    """
    inside, bases = _bases(plan, position)
    lane = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 1)
    node = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 0)

    def read(line, velocity: Pair) -> Pair:
        along_x = plan.delta.weight(inside[0] - (bases[0] + line.astype(f.dtype)))
        along_y = plan.delta.weight(inside[1][:, None] - (bases[1][:, None] + lane.astype(f.dtype)))
        cells = _line(plan, bases, line)
        planes = tuple(triton.load(f.at[(9 * now + i) * plan.cells + cells]) for i in range(9))
        weight = (there * along_x)[:, None] * along_y / fluid.density(planes)
        triton.store(window.at[node, ROW * line + lane], weight)
        x, y = fluid.momentum(planes)
        return velocity[0] + jnp.sum(weight * x, 1), velocity[1] + jnp.sum(weight * y, 1)

    return _repeat(plan.delta.points, read, (jnp.zeros_like(there), jnp.zeros_like(there)))


def _line(plan: Plan, bases: Pair, line):
    """Return the cells of a line of all windows, (node, lane)."""
    lane = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes, ROW), 1).astype(bases[0].dtype)
    x = _wrapped(bases[0] + line.astype(lane.dtype), plan.size[0]).astype(jnp.int32)
    y = _wrapped(bases[1][:, None] + lane, plan.size[1]).astype(jnp.int32)
    return (x * plan.size[1])[:, None] + y


def _clear(plan: Plan, force: Ref, position: Pair) -> None:
    """Set the force in the cells of all windows to zero."""
    bases = _bases(plan, position)[1]

    def write(line, carry):
        cells = _line(plan, bases, line)
        for axis in range(2):
            triton.store(force.at[axis * plan.cells + cells], jnp.zeros(cells.shape, force.dtype))
        return carry

    _repeat(plan.delta.points, write, 0)


def _tabulate(plan: Plan, tables: Ref, position: Pair, there) -> None:
    """Write, for each axis and line of a window, the weights there of all nodes."""
    inside, bases = _bases(plan, position)

    def write(axis: int, line, carry):
        cells = plan.size[axis]
        cell = _wrapped(bases[axis] + line.astype(there.dtype), cells)
        away = inside[axis][None, :] - cell[:, None]
        away = away - cells * jnp.floor(away / cells + 0.5)
        tables[axis, line, :, :] = there[None, :] * plan.delta.weight(away)
        return carry

    for axis in range(2):
        _repeat(plan.delta.points, partial(write, axis), 0)


def _forced(
    plan: Plan, window: Ref, tables: Ref, position: Pair, there, velocity, target: Pair, limit
):
    """Return the force on the fluid, the target less its rigid part, and the limiting factor.

    See `coupling.multi_direct_forcing`; J S / ρ is a matrix here.
    """
    node = jax.lax.broadcasted_iota(jnp.int32, (plan.nodes,), 0)

    def add(number, matrix):
        x, y = _divided(number, plan.delta.points)
        weight = triton.load(window.at[node, ROW * x + y])
        return matrix + weight[:, None] * (tables[0, x, :, :] * tables[1, y, :, :])

    nothing = jnp.zeros((plan.nodes, plan.nodes), there.dtype)
    matrix = _repeat(plan.delta.points**2, add, nothing)
    coverage = jnp.sum(matrix, 1)
    beta = jnp.where(there > 0, 1.0 / jnp.where(there > 0, coverage, 1.0), 0.0)
    rigid = _rigid(plan, beta, position)
    q, reached = (jnp.zeros_like(beta),) * 2, (jnp.zeros_like(beta),) * 2
    for number, length in enumerate(plan.lengths):
        if number:
            reached = tuple(jnp.sum(matrix * one[None, :], 1) for one in q)
        error = _difference(_difference(target, velocity), reached)
        removed = rigid(error)
        q = tuple(
            one + length * beta * (e - r) for one, e, r in zip(q, error, removed, strict=True)
        )
        target = _difference(target, removed)
    largest = jnp.sqrt(jnp.max(q[0] * q[0] + q[1] * q[1]) + 1e-24)
    scale = jnp.minimum(1.0, limit / largest)
    return tuple(plan.force_factor * (one * scale) for one in q), target, scale


def _rigid(plan: Plan, beta, position: Pair) -> Callable[[Pair], Pair]:
    """Return what finds the rigid part of errors, see `coupling.torque_free`."""
    total = jnp.sum(beta)
    x, y = (one - jnp.sum(beta * one) / total for one in position)
    inertia = jnp.sum(beta * (x * x + y * y))

    def rigid(error: Pair) -> Pair:
        moved = tuple(jnp.sum(beta * one) / total for one in error)
        left = _difference(error, moved)
        if not plan.turns:
            return tuple(jnp.broadcast_to(one, beta.shape) for one in moved)
        spin = jnp.sum(beta * (x * left[1] - y * left[0])) / inertia
        return moved[0] - spin * y, moved[1] + spin * x

    return rigid


def _spread(plan: Plan, force: Ref, tables: Ref, position: Pair, forcing: Pair) -> None:
    """Write the force in the cells of all windows.

    Each window has the whole sum over nodes, so that windows that share a cell agree.
    """
    bases = _bases(plan, position)[1]

    def write(number, carry):
        lines = _divided(number, plan.delta.points)
        x, y = (
            _wrapped(base + line.astype(base.dtype), cells).astype(jnp.int32)
            for base, line, cells in zip(bases, lines, plan.size, strict=True)
        )
        weight = tables[0, lines[0], :, :] * tables[1, lines[1], :, :]
        for axis in range(2):
            total = jnp.sum(weight * forcing[axis][None, :], 1)
            triton.store(force.at[axis * plan.cells + x * plan.size[1] + y], total)
        return carry

    _repeat(plan.delta.points**2, write, 0)


def _fitted(shape: Pair, position: Pair, there, count) -> Pair:
    """Return a rest shape about its middle, moved and turned to be nearest to positions."""
    centre = tuple(jnp.sum(there * one) / count for one in position)
    arm, (x, y) = _difference(position, centre), shape
    cosine = jnp.sum(there * (x * arm[0] + y * arm[1]))
    sine = jnp.sum(there * (x * arm[1] - y * arm[0]))
    size = jnp.sqrt(cosine * cosine + sine * sine + 1e-24)
    c, s = cosine / size, sine / size
    return centre[0] + (c * x - s * y), centre[1] + (s * x + c * y)


def _limited(moved: Pair, limit):
    """Return displacements of at most `limit`, their lengths, and 1 where it acts."""
    speed = jnp.sqrt(moved[0] * moved[0] + moved[1] * moved[1] + 1e-24)
    factor = jnp.minimum(1.0, limit / speed)
    x, y = moved[0] * factor, moved[1] * factor
    held = jnp.where(factor < 1, 1.0, 0.0)
    return (x, y), jnp.sqrt(x * x + y * y + 1e-24), held


def _sum(one: Pair, other: Pair) -> Pair:
    return one[0] + other[0], one[1] + other[1]


def _difference(one: Pair, other: Pair) -> Pair:
    return one[0] - other[0], one[1] - other[1]


def _wait(plan: Plan) -> None:
    """Wait until all threads of the program have written."""
    if not plan.interpreted:
        triton.debug_barrier()
