"""MAP-Elites on plain functions of vectors, ours and QDax's with the same numbers."""

import importlib
from functools import cache, partial
from typing import Any

import jax
import jax.numpy as jnp
import loops
import numpy as np

from microcosmos import genomes, search

GENES, CELLS, BATCH, GENERATIONS = 20, 1_024, 256, 400
ISO, LINE = 0.01, 0.1
"""Deviations for genes from 0 to 1, as the functions take them; ours run from −1 to 1."""


def arm(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """A planar arm: low spread of its angles, and the place of its end from 0 to 1.

    Cully et al., Nature 521, 503 (2015), in the form of fast_map_elites.
    """
    angle = jnp.cumsum(2 * jnp.pi * x - jnp.pi)
    end = jnp.stack([jnp.mean(jnp.cos(angle)), jnp.mean(jnp.sin(angle))])
    return -jnp.std(x), (end + 1) / 2


def rastrigin(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Rastrigin's function within ±5, and its first two arguments."""
    z = 10 * x - 5
    return -jnp.sum(10 + z * z - 10 * jnp.cos(2 * jnp.pi * z)), x[:2]


FUNCTIONS: dict[str, loops.Function] = {"arm": arm, "rastrigin": rastrigin}
LEAST = {"arm": -0.5, "rastrigin": -45.0 * GENES}
"""Lower bounds of fitness, so that every elite adds to the score."""


@cache
def cells(count: int = CELLS) -> search.Voronoi:
    """Return the cells, the same for both libraries."""
    axes = tuple(search.Axis(i, 0.0, 1.0, 1, False) for i in range(2))
    return search.voronoi(axes, search.cvt.centroids(count, 2, seed=0))


def ours(name: str, seed: int, generations: int = GENERATIONS, batch: int = BATCH) -> float:
    """Return the QD score that our emitters and archive reach."""
    emitter = search.emitters.IsoLine(batch, newcomer, 2 * ISO, LINE)

    def function(genes: jax.Array) -> tuple[jax.Array, jax.Array]:
        return FUNCTIONS[name]((genes + 1) / 2)

    return score(loops.ours(emitter, function, cells(), GENES, generations, seed), name)


def qdax(name: str, seed: int, generations: int = GENERATIONS, batch: int = BATCH) -> float:
    """Return the QD score of QDax with the same operator, budget and centroids."""
    standard: Any = importlib.import_module("qdax.core.emitters.standard_emitters")
    operators: Any = importlib.import_module("qdax.core.emitters.mutation_operators")
    variation = partial(
        operators.isoline_variation, iso_sigma=ISO, line_sigma=LINE, minval=0.0, maxval=1.0
    )
    evaluate = jax.vmap(FUNCTIONS[name])
    fitness = loops.qdax(
        lambda genotypes, key: (*evaluate(genotypes), {}),
        standard.MixingEmitter(lambda x, key: x, variation, 1.0, batch),
        lambda key: jax.random.uniform(key, (batch, GENES)),
        cells().centroids,
        generations,
        seed,
    )
    return score(fitness, name)


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Return uniform genes."""
    return genomes.Vector(jax.random.uniform(key, (GENES,), minval=-1.0, maxval=1.0))


def score(fitness: np.ndarray, name: str) -> float:
    """Return the sum over elites of fitness above the least."""
    return float(np.sum(fitness.astype(float) - LEAST[name]))
