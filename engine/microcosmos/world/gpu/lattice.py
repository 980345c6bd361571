"""The fluid of a world: cells in tiles, collided and streamed in place.

Populations have one copy. In even steps they stand in their cells, and a collision leaves each
where it came from, under its opposite direction; in odd steps a cell finds them there, with
its neighbours, and leaves them in the usual order (Bailey et al., ICPP 2009, the AA pattern).
A cell writes only where it has read, so that threads need no order.
"""

import jax
import jax.numpy as jnp
from jax.experimental.pallas import triton

from ... import fluid
from .plan import Plan, Ref, divided, repeat, wrapped

TILE = 256
"""Cells that a program collides at once."""
OPPOSITE = (0, 2, 1, 4, 3, 6, 5, 8, 7)


def prepare(plan: Plan, start: Ref, f: Ref, force: Ref) -> None:
    """Copy the first populations, and clear the force."""

    def copy(number, carry):
        at, inside = _cells(plan, number)
        for i in range(9):
            values = triton.load(
                start.at[i * plan.cells + at], mask=inside, other=_other(inside)
            )
            triton.store(f.at[i * plan.cells + at], values, mask=inside)
        for axis in range(2):
            zero = jnp.zeros(at.shape, f.dtype)
            triton.store(force.at[axis * plan.cells + at], zero, mask=inside)
        return carry

    repeat(-(-plan.cells // TILE), copy, 0)
    wait(plan)


def wait(plan: Plan) -> None:
    """Wait until all threads of the program have written."""
    if not plan.interpreted:  # The interpreter works in order and has no barriers.
        triton.debug_barrier()


def flow(plan: Plan, f: Ref, force: Ref, odd, rates: fluid.Rates):
    """Collide and stream all cells; return the speed of the fastest fluid before."""

    def collide(number, fastest):
        at, inside = _cells(plan, number)
        places = addresses(plan, odd, *divided(at, plan.size[1]))
        if inside is not None:  # Beyond memory, so that no cell counts twice.
            places = [jnp.where(inside, place, 9 * plan.cells) for place in places]
        planes = tuple(
            triton.load(f.at[place], mask=inside, other=_other(inside)) for place in places
        )
        pushed = tuple(
            triton.load(force.at[axis * plan.cells + at], mask=inside, other=_other(inside))
            for axis in range(2)
        )
        rho, momentum = fluid.density(planes), fluid.momentum(planes)
        collided = fluid.collide(planes, rho, momentum, (pushed[0], pushed[1]), rates)
        for place, i in zip(places, OPPOSITE, strict=True):
            triton.store(f.at[place], collided[i], mask=inside)
        square = momentum[0] * momentum[0] + momentum[1] * momentum[1]
        return jnp.maximum(fastest, square / (rho * rho))

    fastest = repeat(-(-plan.cells // TILE), collide, jnp.zeros((1, TILE), f.dtype))
    return jnp.sqrt(jnp.max(fastest) + 1e-24)


def addresses(plan: Plan, odd, x, y) -> list:
    """Return the places of the populations of cells, by direction, before a step.

    `odd` is 1 before an odd step and 0 before an even one.
    """
    places = []
    for i, (dx, dy) in enumerate(fluid.DIRECTIONS):
        plane = i + odd * (OPPOSITE[i] - i)
        row = wrapped(x - odd * dx, plan.size[0])
        places.append(
            plane * plan.cells + row * plan.size[1] + wrapped(y - odd * dy, plan.size[1])
        )
    return places


def restored(plan: Plan, f: jax.Array) -> jax.Array:
    """Return populations (direction, x, y) in the usual order after the last step."""
    planes = f.reshape(9, *plan.size)
    if plan.steps % 2 == 0:
        return planes
    moved = (
        jnp.roll(planes[opposite], c, (0, 1))
        for opposite, c in zip(OPPOSITE, fluid.DIRECTIONS, strict=True)
    )
    return jnp.stack(list(moved))


def _cells(plan: Plan, number):
    """Return the numbers of a tile's cells, and the mask of those in the box; None: all."""
    at = number * TILE + jax.lax.broadcasted_iota(jnp.int32, (1, TILE), 1)
    return at, at < plan.cells if plan.cells % TILE else None


def _other(inside) -> float | None:
    return None if inside is None else 0.0
