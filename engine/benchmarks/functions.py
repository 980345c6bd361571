"""MAP-Elites on plain functions of vectors, ours and QDax's with the same numbers."""

import importlib
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, neat, search

GENES, CELLS, BATCH, GENERATIONS = 20, 1_024, 256, 400
ISO, LINE = 0.01, 0.1
"""Of genes from 0 to 1, as the functions take them; ours run from −1 to 1."""

Function = Callable[[jax.Array], tuple[jax.Array, jax.Array]]


def arm(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """A planar arm: small differences of its angles, 0 to 1, and where it ends.

    Cully et al., Nature 521, 503 (2015), in the form of fast_map_elites.
    """
    angle = jnp.cumsum(2 * jnp.pi * x - jnp.pi)
    end = jnp.stack([jnp.mean(jnp.cos(angle)), jnp.mean(jnp.sin(angle))])
    return -jnp.std(x), (end + 1) / 2


def rastrigin(x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Rastrigin's function within ±5, and its first two arguments."""
    z = 10 * x - 5
    return -jnp.sum(10 + z * z - 10 * jnp.cos(2 * jnp.pi * z)), x[:2]


FUNCTIONS: dict[str, Function] = {"arm": arm, "rastrigin": rastrigin}
LEAST = {"arm": -0.5, "rastrigin": -45.0 * GENES}
"""No less than this is possible, so that every elite adds to the score."""


@cache
def cells(count: int = CELLS) -> search.Voronoi:
    """Both libraries are given the same centroids."""
    axes = tuple(search.Axis(i, 0.0, 1.0, 1, False) for i in range(2))
    return search.voronoi(axes, search.cvt.centroids(count, 2, seed=0))


def ours(name: str, seed: int, generations: int = GENERATIONS, batch: int = BATCH) -> float:
    """The QD score that our emitters and archive reach."""
    emitter = search.emitters.IsoLine(batch, newcomer, 2 * ISO, LINE)
    archive_cells, key = cells(), jax.random.key(seed)
    evaluate = jax.vmap(FUNCTIONS[name])

    def generation(archive: search.Elites, number: jax.Array) -> tuple[search.Elites, None]:
        children, _, _ = search.emitters.emit(
            (emitter,), (None,), archive, neat.first_counters(1, 1), number, key=key
        )
        assert isinstance(children.genotypes, genomes.Vector)
        values = children.genotypes.values
        fitness, places = evaluate((values + 1) / 2)
        found = search.Elites(
            occupied=jnp.ones(batch, bool),
            fitness=fitness,
            measures=places,
            generation=jnp.full(batch, number, jnp.int32),
            slot=jnp.arange(batch, dtype=jnp.int32),
            genotypes=children.genotypes,
        )
        return search.insert(archive, found, archive_cells)[0], None

    nobody = search.no_elites(archive_cells.count, 2, genomes.Vector(jnp.zeros(GENES)))
    run = jax.jit(lambda a: jax.lax.scan(generation, a, jnp.arange(generations))[0])
    archive = run(nobody)
    return score(np.asarray(archive.fitness)[np.asarray(archive.occupied)], name)


def theirs(name: str, seed: int, generations: int = GENERATIONS, batch: int = BATCH) -> float:
    """The QD score that QDax reaches with the same operator, budget and centroids."""
    loop: Any = importlib.import_module("qdax.core.map_elites")
    standard: Any = importlib.import_module("qdax.core.emitters.standard_emitters")
    operators: Any = importlib.import_module("qdax.core.emitters.mutation_operators")
    variation = partial(
        operators.isoline_variation, iso_sigma=ISO, line_sigma=LINE, minval=0.0, maxval=1.0
    )
    evaluate = jax.vmap(FUNCTIONS[name])
    search_of = loop.MAPElites(
        scoring_function=lambda genotypes, key: (*evaluate(genotypes), {}),
        emitter=standard.MixingEmitter(lambda x, key: x, variation, 1.0, batch),
        metrics_function=lambda repertoire: {},
    )
    first_key, init_key, key = jax.random.split(jax.random.PRNGKey(seed), 3)
    first = jax.random.uniform(first_key, (batch, GENES))
    repertoire, state, _ = search_of.init(first, cells().centroids, init_key)
    run = jax.jit(
        lambda carry: jax.lax.scan(search_of.scan_update, carry, length=generations - 1)[0]
    )
    (repertoire, _, _) = run((repertoire, state, key))
    fitness = np.asarray(repertoire.fitnesses)[:, 0]
    return score(fitness[np.isfinite(fitness)], name)


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Uniform genes."""
    return genomes.Vector(jax.random.uniform(key, (GENES,), minval=-1.0, maxval=1.0))


def score(fitness: np.ndarray, name: str) -> float:
    """Σ over elites of fitness above the least."""
    return float(np.sum(fitness.astype(float) - LEAST[name]))
