"""Worlds with slots at full size: random crowds in both engines, a ledger of 100,000 windows.

`tests/engine/world/test_slots.py` has the same at a tiny size.
"""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import rich
from crowds import (
    BODIES,
    SLOTS,
    crowd,
    in_jax,
    in_kernel,
    ledger,
    momentum,
    same,
)

CROWDS, WINDOWS, STEPS = 200, 100_000, 5
MEDIAN, MOST = 2e-4, 5e-2
"""Bounds on the distance of nodes in both engines after 100 steps, in cells: contact and senses
make some crowds grow every difference."""


def crowds() -> bool:
    """Compare the kernel with JAX, balance the quanta of a long life, and weigh the water."""
    return all([_compared(), _balanced(), _still()])


def _compared() -> bool:
    found = []
    for number in range(CROWDS):
        random = np.random.default_rng(number)
        name = list(BODIES)[number % len(BODIES)]
        place, held, living = crowd(name, count=int(random.integers(1, SLOTS + 1)), seed=number)
        place = replace(place, viscosity=jnp.float32(random.uniform(0.02, 0.2)))
        end = other = living
        for _ in range(10):
            end, _ = in_jax(place, held, end, 10, 3)
            other, _ = in_kernel(place, held, other, 10, 3)
        away = np.asarray(end.positions - other.positions)
        away = away - 48 * np.round(away / 48)
        found.append(float(np.abs(away).max()))
    middle, most = np.median(found), np.percentile(found, 95)
    rich.print(
        f"{CROWDS} crowds, kernel beside JAX after 100 steps: {middle:.1e} cells in the "
        f"median, {most:.1e} in 95 of 100"
    )
    return bool(middle < MEDIAN and most < MOST)


def _balanced() -> bool:
    found, there, born = [], [], 0
    for balanced, last in ledger(in_kernel, WINDOWS, change=20):
        found.append(balanced)
        *there, born = last
    again, alone = (in_kernel(*there, STEPS, threads=threads)[0] for threads in (2, 1))
    rich.print(
        f"{WINDOWS:,} windows, {born} births: the ledger differed in {found.count(False)}"
    )
    return all(found) and same(again, alone)


def _still() -> bool:
    """Tell whether the water gains no momentum beside what bodies exert on it.

    The sum of forces is at least the work over the largest speed.
    """
    place, held, living = crowd(count=6, seed=4)
    work, fastest = 0.0, 0.0
    for _ in range(100):
        living, tally = in_kernel(place, held, living, 1000, 3)
        work += float(np.sum(tally.work))
        fastest = max(fastest, float(np.max(tally.mach)) / np.sqrt(3))
    drift = float(np.abs(momentum(living).sum((0, 1))).max())
    share = drift * fastest / work
    rich.print(f"100,000 steps: the water's momentum is {share:.1e} of all forces")
    return share < 1e-6
