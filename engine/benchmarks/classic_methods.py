"""Methods that `classic` compares: our emitters and search, and the parts of the others."""

import importlib
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from classic_tasks import BATCH, BINS, EMITTERS, GENES, RATE, REACH, Task

from microcosmos import genomes, search

PAIRS = {"iso+line": "QDax iso+line", "CMA-MAE": "pyribs CMA-MAE"}
"""Each of our methods, and the one that it is compared with."""


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Return normal genes of deviation 1, on the scale of a task."""
    return genomes.Vector(jax.random.normal(key, (GENES,)) / REACH)


def our_search(emitter: search.Emitter, task: Task, seed: int) -> search.Search:
    axes = tuple(search.Axis(i, -task.limit, task.limit, BINS) for i in range(2))
    space = search.Vectors(GENES, -REACH, REACH)
    return search.Search(space, search.Grid(axes), [emitter], seed=seed)


def iso_line(task: Task) -> search.emitters.IsoLine:
    return search.emitters.IsoLine(BATCH, newcomer, task.iso / REACH, task.line)


def cma_mae(task: Task) -> search.emitters.CmaMae:
    step = task.step / REACH
    return search.emitters.CmaMae(BATCH, newcomer, BINS**2, step, RATE, 0.0, EMITTERS)


def qdax_parts(task: Task) -> tuple[Callable, Any, Callable, jax.Array]:
    """Return QDax's scoring function, emitter, first vectors of a key, and centroids."""
    standard: Any = importlib.import_module("qdax.core.emitters.standard_emitters")
    operators: Any = importlib.import_module("qdax.core.emitters.mutation_operators")
    variation = partial(operators.isoline_variation, iso_sigma=task.iso, line_sigma=task.line)
    emitter = standard.MixingEmitter(lambda x, key: x, variation, 1.0, BATCH)
    axes = tuple(search.Axis(i, 0.0, 1.0, BINS) for i in range(2))

    def scored(vectors: jax.Array, key: Any) -> tuple[jax.Array, jax.Array, dict]:
        fitness, measures = jax.vmap(task.function)(vectors)
        return fitness, (measures / task.limit + 1) / 2, {}

    def first(key: jax.Array) -> jax.Array:
        return jax.random.normal(key, (BATCH, GENES))

    return scored, emitter, first, jnp.asarray(search.Grid(axes).centres)


def pyribs_parts(task: Task, seed: int) -> tuple[Any, Any]:
    """Return pyribs' scheduler of CMA-MAE and its archive of results."""
    names = ("archives", "emitters", "schedulers")
    archives, emitters, schedulers = (importlib.import_module(f"ribs.{n}") for n in names)
    ranges = [(-task.limit, task.limit)] * 2
    grid = {"solution_dim": GENES, "dims": (BINS, BINS), "ranges": ranges}
    archive = archives.GridArchive(**grid, learning_rate=RATE, threshold_min=0.0, seed=seed)
    results = archives.GridArchive(**grid, seed=seed)
    strategies = [
        emitters.EvolutionStrategyEmitter(
            archive,
            x0=np.zeros(GENES),
            sigma0=task.step,
            ranker="imp",
            selection_rule="mu",
            restart_rule="basic",
            batch_size=BATCH // EMITTERS,
            seed=EMITTERS * seed + i,
        )
        for i in range(EMITTERS)
    ]
    return schedulers.Scheduler(archive, strategies, result_archive=results), results
