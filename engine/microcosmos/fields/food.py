"""Energy in whole numbers: a second form beside the paper's, in which no quantum is lost.

Nodes eat quanta from their cells. The rest is carried by the flow, spreads, decays and regrows
every so many steps. Amounts are rounded towards zero before anything moves, so that sums are
exact on any machine and in any order; the form has no gradients.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

Quanta = Int[Array, "x y"]
Rows = Int[Array, "x 2"]
"""Quanta of each row: 4096 times the first number, and the second."""

MOST = 2**24
"""Largest capacity of a cell, in quanta: up to here float32 is exact."""
FULL_ACCOUNT = 2**30
"""Quanta with which a creature eats no more: an account is an int32."""


class Food(eqx.Module):
    """How quanta are eaten, and how the others change."""

    capacity: Quanta
    """Towards which food regrows."""
    bite: Float[Array, ""]
    """Most quanta that a node eats in a step; for all nodes of a creature at most 2³⁰."""
    regrowth: Float[Array, ""]
    """Share of what is missing that regrows every `every` steps, at most 1."""
    decay: Float[Array, ""]
    """Share of food that decays every `every` steps, at most 1."""
    diffusion: Float[Array, ""]
    """Share of a difference that flows to the neighbour every `every` steps, at most 1/4."""
    unit: Float[Array, ""]
    """Quanta that are sensed as an energy of 1."""
    full: Float[Array, ""]
    """Quanta in a creature's account that it senses as 1."""
    carried: bool = eqx.field(static=True, default=True)
    """Whether the flow carries food."""
    every: int = eqx.field(static=True, default=20)

    def __check_init__(self):
        if self.every < 1:
            raise ValueError(f"`every` must be at least 1 step, got {self.every}.")
        if not jnp.issubdtype(self.capacity.dtype, jnp.integer):
            raise ValueError(
                f"`capacity` must be in whole quanta, got {self.capacity.dtype.name}."
            )


def eaten(
    food: Quanta,
    positions: Float[Array, "node 2"],
    eaters: Bool[Array, "node"],
    bite: Float[Array, ""],
) -> tuple[Quanta, Int[Array, "node"]]:
    """Return the food that is left, and what each node eats.

    A node eats from its nearest cell, at most `bite`. Of n eaters of a cell each gets the n-th
    part at most, rounded down; the rest stays.
    """
    x, y = (
        jnp.mod(jnp.floor(positions[:, axis] + 0.5), food.shape[axis]).astype(jnp.int32)
        for axis in (0, 1)
    )
    count = jnp.zeros_like(food).at[x, y].add(eaters.astype(food.dtype))
    share = jnp.minimum(bite.astype(food.dtype), food // jnp.maximum(count, 1))
    return food - count * share, jnp.where(eaters, share[x, y], 0)


def changed(
    food: Quanta, given: Food, velocity: Float[Array, "2 x y"], solid: Bool[Array, "x y"] | None
) -> tuple[Quanta, Rows, Rows]:
    """Return food after it has been carried, has spread, decayed and regrown, with the quanta
    that have grown and that are lost in each row.

    The flow carries by the velocity at the faces of cells, upwind, in turns of at most four
    steps. At most a quarter of a cell's food passes each face in a turn. So where `every` is a
    multiple of 4, water faster than 1/16 cells a step carries food more slowly than itself.
    """
    if given.carried:
        turns = -(-given.every // 4)
        length = given.every / turns
        shares = []
        for axis in (0, 1):
            face = 0.5 * (velocity[axis] + jnp.roll(velocity[axis], -1, axis))
            shares.append(jnp.clip(face * length, -0.25, 0.25))
        for _ in range(turns):
            flows = []
            for axis, share in enumerate(shares):
                source = jnp.where(share > 0, food, jnp.roll(food, -1, axis))
                flows.append(_within(_whole(source, share), food, axis))
            food = _moved(food, flows, solid)
    flows = [
        _within(_whole(food - jnp.roll(food, -1, axis), given.diffusion), food, axis)
        for axis in (0, 1)
    ]
    food = _moved(food, flows, solid)
    # Beyond 2²⁴ quanta the product may be more than there is.
    lost = jnp.minimum(_whole(food, given.decay), food)
    left = food - lost
    grown = _whole(jnp.maximum(given.capacity - left, 0), given.regrowth)
    return left + grown, summed(grown), summed(lost)


def summed(quanta: Quanta) -> Rows:
    """Return the sum over each row in two parts: an int32 would be too small for it."""
    return added(jnp.stack([quanta >> 12, quanta & 4095], 2), 1)


def added(rows: Int[Array, "*any 2"], axis: int) -> Rows:
    """Return sums over an axis of numbers in two parts."""
    high, low = jnp.moveaxis(jnp.sum(rows, axis, dtype=rows.dtype), -1, 0)
    return jnp.stack([high + (low >> 12), low & 4095], -1)


def total(rows: Rows) -> int:
    """Return the quanta of all rows."""
    high, low = np.asarray(rows, np.int64).reshape(-1, 2).sum(0)
    return int(4096 * high + low)


def _whole(quanta: Quanta, share: Float[Array, "*any"]) -> Quanta:
    """Return a share of quanta, rounded towards zero."""
    return (quanta.astype(share.dtype) * share).astype(quanta.dtype)


def _within(flow: Quanta, food: Quanta, axis: int) -> Quanta:
    """Return a flow of at most a quarter of the giver's quanta, also beyond 2²⁴ of them."""
    return jnp.clip(flow, -(jnp.roll(food, -1, axis) // 4), food // 4)


def _moved(food: Quanta, flows: list[Quanta], solid: Bool[Array, "x y"] | None) -> Quanta:
    """Return food after quanta have flowed to the next cell along each axis."""
    for axis, flow in enumerate(flows):
        if solid is not None:
            flow = jnp.where(solid | jnp.roll(solid, -1, axis), 0, flow)
        food = food - flow + jnp.roll(flow, 1, axis)
    return food
