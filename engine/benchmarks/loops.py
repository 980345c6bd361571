"""Loops of MAP-Elites over plain functions of vectors, ours and QDax's."""

import importlib
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from microcosmos import genomes, neat, search

Function = Callable[[jax.Array], tuple[jax.Array, jax.Array]]
"""A function of a vector: its fitness, and its descriptors from 0 to 1."""


def ours(
    emitter: Any,
    function: Function,
    cells: search.Cells,
    genes: int,
    generations: int,
    seed: int,
    slopes: Callable[[jax.Array], jax.Array] | None = None,
) -> np.ndarray:
    """Return the elites' fitness; the emitter learns `slopes` of a vector once a generation."""
    key = jax.random.key(seed)

    def generation(carry: Any, number: jax.Array) -> tuple[Any, None]:
        archive, state = carry
        children, (state,), _ = search.emitters.emit(
            (emitter,), (state,), archive, neat.first_counters(1, 1), number, key=key
        )
        if slopes is not None:
            rows = jax.vmap(slopes)(emitter.to_differentiate(state, children).values)
            known = search.Slopes(rows, jnp.ones(len(rows), bool))
            children, state = emitter.learn(state, children, known)
        genotypes: Any = children.genotypes
        fitness, descriptors = jax.vmap(function)(genotypes.values)
        feasible = jnp.ones(len(fitness), bool)
        rows = search.candidates(number, genotypes, fitness, descriptors, feasible)
        archive, inserted = search.insert(archive, rows, cells)
        outcome = search.emitters.outcome(rows, inserted)
        return (archive, emitter.tell(state, outcome)), None

    empty = search.no_elites(cells.count, 2, genomes.Vector(jnp.zeros(genes)))
    run = jax.jit(lambda carry: jax.lax.scan(generation, carry, jnp.arange(generations))[0])
    archive, _ = run((empty, emitter.init(key=key)))
    return np.asarray(archive.fitness)[np.asarray(archive.occupied)]


def qdax(
    scored: Callable,
    emitter: Any,
    first: Callable[[jax.Array], jax.Array],
    centroids: jax.Array,
    generations: int,
    seed: int,
) -> np.ndarray:
    """Return the elites' fitness in QDax's loop; `first` makes the first vectors from a key."""
    loop: Any = importlib.import_module("qdax.core.map_elites")
    search_of = loop.MAPElites(scored, emitter, lambda repertoire: {})
    first_key, init_key, key = jax.random.split(jax.random.PRNGKey(seed), 3)
    repertoire, state, _ = search_of.init(first(first_key), centroids, init_key)
    run = jax.jit(
        lambda carry: jax.lax.scan(search_of.scan_update, carry, length=generations - 1)[0]
    )
    repertoire, _, _ = run((repertoire, state, key))
    fitness = np.asarray(repertoire.fitnesses)[:, 0]
    return fitness[np.isfinite(fitness)]
