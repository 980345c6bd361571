"""A whole rollout in one program per world, written in Pallas for Triton, for GPUs.

A program takes the steps of `stepping` in the same order, with vectors of nodes in registers
and the fluid in the near memory of the chip. Nothing depends on the order in which threads
write.
"""

from collections.abc import Sequence
from functools import partial

import jax
import jax.numpy as jnp
from jax.experimental import pallas
from jax.experimental.pallas import triton
from jaxtyping import Array

from ... import fluid
from .bodies import (
    ROW,
    clear,
    fitted,
    forced,
    interpolate,
    limited,
    spread,
    tabulate,
    within_box,
)
from .lattice import flow, prepare, restored, wait
from .plan import Pair, Plan, Ref, added, difference, divided, repeat

WARPS = 4
"""Groups of 32 threads in a program."""
RATES = ("even", "odd", "displacement", "force")
"""Relaxation rates and limits, in the order of the operand."""
OBSERVED = ("speed", "node_speed", "held", "power", "force_x", "force_y", "box_x", "box_y")
"""Numbers that a step returns beside positions; the last are the boxes that the body changed
by."""


def rollout(plan: Plan, operands: Sequence[Array]) -> list[Array]:
    """Return populations, positions, positions before the limit, and numbers of each step.

    Operands are the populations, positions (axis, node), 1 for present nodes, 1 for the
    anchor, rest shapes (time, axis, node), and `RATES`. Results but the populations have time
    first.
    """
    shapes = [
        (9 * plan.cells,),
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
    # Force, windows and tables are results only to have memory on the device.
    f, _, _, _, *observed = call(*operands)
    return [restored(plan, f), *observed]


def _rollout(
    plan: Plan, start, placed, present, anchor, shapes, numbers, f, force, window, tables, *out
):
    """Carry one world through all steps; arguments after the plan are memory."""
    rates = fluid.Rates(numbers[0], numbers[1])
    mask, chosen = present[:], anchor[:]
    count = jnp.sum(mask)
    prepare(plan, start, f, force)

    def step(time, position: Pair) -> Pair:
        odd = divided(time, 2)[1]
        velocity = interpolate(plan, f, window, odd, position, mask)
        tabulate(plan, tables, position, mask)
        wait(plan)  # `forced` reads windows and tables that other threads write.
        shape = shapes[time, 0, :], shapes[time, 1, :]
        matched = fitted(shape, added(position, velocity), mask, count)
        wanted, speed, held = limited(difference(matched, position), numbers[2])
        forcing, target, scale = forced(
            plan, window, tables, position, mask, velocity, wanted, numbers[3]
        )
        spread(plan, force, tables, position, forcing)
        wait(plan)  # The fluid reads the force that all nodes have spread.
        fastest = flow(plan, f, force, odd, rates)
        wait(plan)  # No force may be cleared before its cell has collided.
        clear(plan, force, position)
        wait(plan)
        position = added(position, (mask * target[0], mask * target[1]))
        position, boxes = within_box(plan, position, chosen)
        held = jnp.where(scale < 1, mask, held)
        power = forcing[0] * target[0] + forcing[1] * target[1]
        means = jnp.sum(mask * speed) / count, jnp.sum(mask * held) / count
        pushed = jnp.sum(power), jnp.sum(forcing[0]), jnp.sum(forcing[1])
        _record(out, time, position, matched, (fastest, *means, *pushed, *boxes))
        return position

    repeat(plan.steps, step, (placed[0, :], placed[1, :]))


def _record(out: tuple[Ref, ...], time, position: Pair, shape: Pair, values: tuple) -> None:
    path, matched, observed = out
    for axis in range(2):
        path[time, axis, :] = position[axis]
        matched[time, axis, :] = shape[axis]
    for number, value in enumerate(values):
        observed[time, number] = value
