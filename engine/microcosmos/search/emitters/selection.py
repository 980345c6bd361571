"""Selection of parents among the elites of an archive."""

from typing import Literal

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray

from ..insertion import MAX_INT, Elites, Inserted, height

Select = Literal["uniform", "mixed", "tournament", "curiosity"]
TOURNAMENTS = {"uniform": 0.0, "mixed": 0.5, "tournament": 1.0, "curiosity": 0.5}
"""The share of parents that are drawn as winners of a tournament."""
ENTERED, REFUSED, LEAST = 1.0, -0.5, 0.05
"""What a child that enters, or does not, adds to its parent's curiosity, which is at least
`LEAST`."""


def draw(archive: Elites, select: Select = "uniform", *, key: PRNGKeyArray) -> Int[Array, ""]:
    """Draw an occupied cell; 0 where none is.

    Chances are equal (uniform), those of the fittest of three such draws (tournament), or the
    mean of both (mixed), which `curiosity` multiplies by the elites' scores (Cully and Demiris,
    IEEE Trans. Evol. Comput. 2018, section III.C).
    """
    # Under `vmap` over keys this is computed once.
    below = jnp.cumsum(_chances(archive, select))
    place = jax.random.uniform(key) * below[-1]
    # Rounding must not reach the end, which may be an empty cell.
    place = jnp.minimum(place, jnp.nextafter(below[-1], 0.0))
    found = jnp.searchsorted(below, place, side="right")
    return jnp.where(below[-1] > 0, found, 0).astype(jnp.int32)


def credit(
    archive: Elites, parents: Int[Array, "slot"], inserted: Inserted
) -> Float[Array, "cell"]:
    """Return the curiosity of elites after the children of parents were inserted.

    `parents` are cells; other numbers are ignored. The score of a new elite is 1.
    """
    cells = archive.occupied.shape[0]
    gain = jnp.where(inserted.entered, ENTERED, REFUSED)
    parent = jnp.where((parents >= 0) & (parents < cells), parents, cells)
    # Multiples of a half: their sum is exact in any order.
    gained = jnp.zeros(cells, jnp.float32).at[parent].add(gain, mode="drop")
    score = archive.curiosity + gained
    new = jnp.where(inserted.entered, inserted.cell, cells)
    score = jnp.maximum(score, LEAST).at[new].set(1.0, mode="drop")
    return jnp.where(archive.occupied, score, 0.0)


def _chances(archive: Elites, select: Select) -> Float[Array, "cell"]:
    """Return numbers proportional to each cell's chance, 0 where it is empty."""
    there, share = archive.occupied, TOURNAMENTS[select]
    chances = there.astype(jnp.float32)
    if share:
        many = jnp.maximum(jnp.sum(there), 1)
        # XLA sorts whole numbers several times faster than an index by floats.
        own = jnp.where(there, height(archive.fitness), MAX_INT)
        rows = jnp.sort(own)
        lower = jnp.searchsorted(rows, own)
        equal = jnp.searchsorted(rows, own, side="right") - lower
        # Of n from below, e equally fit ones after l others win (l + e)³ − l³ of n³ tournaments
        # of three, which they share.
        low, step = lower / many, equal / many
        wins = 3 * low * low + 3 * low * step + step * step
        chances = jnp.where(there, (1 - share) + share * wins, 0.0)
    return chances * archive.curiosity if select == "curiosity" else chances
