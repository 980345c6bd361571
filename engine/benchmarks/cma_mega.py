"""CMA-MEGA where derivatives are known: ours, QDax's and pyribs', equal budgets and cells."""

import importlib
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import loops
import numpy as np
import timing

from microcosmos import genomes, search

GENES, BINS, BATCH, GENERATIONS, SEEDS = 100, 100, 36, 2_000, (0, 1, 2)
LIMIT, BEST = 5.12, 0.4 * 5.12
STEP = 10.0
"""Initial deviation of coefficients and ascent's rate of 1, as in the paper's section 6."""

AXES = tuple(search.Axis(i, 0.0, 1.0, BINS, False) for i in range(2))


def _projected(x: jax.Array) -> jax.Array:
    """Return means of the first and of the second half, 0 to 1; values beyond ±5.12 fold back.

    Linear projection: Fontaine et al., GECCO 2020, section 4.
    """
    beyond = jnp.abs(x) > LIMIT
    clipped = jnp.where(beyond, LIMIT / jnp.where(beyond, x, 1.0), x)
    return (jnp.stack([jnp.mean(half) for half in jnp.split(clipped, 2)]) / LIMIT + 1) / 2


def _scaled(value: Callable[[jax.Array], jax.Array]) -> loops.Function:
    """Scale a function from 0 in the worst corner to 1 at the optimum."""
    worst = value(jnp.full(GENES, -LIMIT))
    return lambda x: (1 - value(x) / worst, _projected(x))


def _sphere(x: jax.Array) -> jax.Array:
    return jnp.sum((x - BEST) ** 2)


def _rastrigin(x: jax.Array) -> jax.Array:
    return jnp.sum(10 + (x - BEST) ** 2 - 10 * jnp.cos(2 * jnp.pi * (x - BEST)))


FUNCTIONS = {"sphere": _scaled(_sphere), "Rastrigin": _scaled(_rastrigin)}


def with_slopes(function: loops.Function, x: jax.Array) -> tuple[jax.Array, ...]:
    """Return value, descriptors, and rows of derivatives."""
    value_slope, descriptor_slopes = jax.jacrev(function)(x)
    return *function(x), jnp.concatenate([value_slope[None], descriptor_slopes])


def score(fitness: np.ndarray) -> tuple[float, float]:
    """Return QD score and coverage in percent of the maximum."""
    count = BINS**2
    return 100 * float(np.sum(fitness)) / count, 100 * len(fitness) / count


def ours(function: loops.Function, seed: int) -> np.ndarray:
    """Return the elites' fitness; our genes run from −1 to 1."""
    emitter = search.emitters.CmaMega(BATCH, newcomer, outputs=3, step=STEP / LIMIT)

    def scaled(genes: jax.Array) -> tuple[jax.Array, jax.Array]:
        return function(LIMIT * genes)

    def slopes(genes: jax.Array) -> jax.Array:
        return with_slopes(function, LIMIT * genes)[2]

    return loops.ours(emitter, scaled, search.Grid(AXES), GENES, GENERATIONS, seed, slopes)


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Return random genes near the middle."""
    return genomes.Vector(0.01 * jax.random.normal(key, (GENES,)))


def qdax(function: loops.Function, seed: int) -> np.ndarray:
    """Return the elites' fitness by QDax's emitter in its own loop."""
    mega: Any = importlib.import_module("qdax.core.emitters.cma_mega_emitter")

    def scored(x: jax.Array, key: jax.Array) -> tuple[jax.Array, jax.Array, dict]:
        value, descriptors, rows = jax.vmap(lambda one: with_slopes(function, one))(x)
        rows = rows / jnp.maximum(jnp.linalg.norm(rows, axis=2, keepdims=True), 1e-30)
        return value, descriptors, {"normalized_grads": jnp.swapaxes(rows, 1, 2)}

    centroids = jnp.asarray(search.Grid(AXES).centres)
    emitter = mega.CMAMEGAEmitter(
        scoring_function=scored,
        batch_size=BATCH,
        learning_rate=1.0,
        num_descriptors=2,
        centroids=centroids,
        sigma_g=STEP,
    )

    def first(key: jax.Array) -> jax.Array:
        return 0.01 * LIMIT * jax.random.normal(key, (BATCH, GENES))

    return loops.qdax(scored, emitter, first, centroids, GENERATIONS, seed)


def pyribs(function: loops.Function, seed: int) -> np.ndarray:
    """Return the elites' fitness by pyribs, whose authors invented the algorithm."""
    names = ("archives", "emitters", "schedulers")
    archives, emitters, schedulers = (importlib.import_module(f"ribs.{n}") for n in names)
    archive = archives.GridArchive(
        solution_dim=GENES, dims=(BINS, BINS), ranges=[(0, 1), (0, 1)], seed=seed
    )
    emitter = emitters.GradientArborescenceEmitter(
        archive,
        x0=np.zeros(GENES),
        sigma0=STEP,
        lr=1.0,
        grad_opt="gradient_ascent",
        selection_rule="mu",
        restart_rule="no_improvement",
        batch_size=BATCH,
        seed=seed,
    )
    scheduler = schedulers.Scheduler(archive, [emitter])
    evaluate = jax.jit(jax.vmap(function))
    slopes = jax.jit(jax.vmap(lambda one: with_slopes(function, one)))
    for _ in range(GENERATIONS):
        scheduler.tell_dqd(*(np.array(x) for x in slopes(scheduler.ask_dqd())))
        scheduler.tell(*(np.asarray(x) for x in evaluate(scheduler.ask())))
    return np.asarray(archive.data("objective"))


def measured(run: Callable, function: loops.Function, seed: int) -> tuple[float, ...]:
    """Return QD score, coverage and seconds of one run."""
    start = time.monotonic()
    return *score(run(function, seed)), time.monotonic() - start


def main() -> None:
    title = (
        f"CMA-MEGA, {GENERATIONS:,} generations of {BATCH} in {GENES} dimensions, "
        f"{BINS} × {BINS} cells: median of {len(SEEDS)} seeds (range)"
    )
    libraries: dict[str, Callable] = {"microcosmos": ours}
    libraries |= {"QDax": qdax} if timing.installed("qdax") else {}
    libraries |= {"pyribs": pyribs} if timing.installed("ribs") else {}
    rows = []
    for name, function in FUNCTIONS.items():
        for library, run in libraries.items():
            columns = zip(*(measured(run, function, seed) for seed in SEEDS), strict=True)
            rows.append((name, library, *map(timing.median_range, columns)))
    timing.print_table(title, ("", "", "QD score, %", "coverage, %", "seconds"), rows)


if __name__ == "__main__":
    main()
