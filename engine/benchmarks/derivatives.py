"""CMA-MEGA where derivatives are known: ours, QDax's and pyribs', equal budgets and cells."""

import importlib
import statistics
import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from rich.console import Console
from rich.table import Table

from microcosmos import genomes, neat, search

GENES, BINS, BATCH, GENERATIONS, SEEDS = 100, 100, 36, 2_000, (0, 1, 2)
LIMIT, BEST = 5.12, 0.4 * 5.12
STEP = 10.0
"""Initial deviation of coefficients and ascent's rate of 1, as in the paper's section 6."""

Function = Callable[[jax.Array], tuple[jax.Array, jax.Array]]


def _projected(x: jax.Array) -> jax.Array:
    """Means of the first and of the second half, 0 to 1; what is beyond ±5.12 folds back.

    The linear projection of Fontaine et al., GECCO 2020, section 4.
    """
    beyond = jnp.abs(x) > LIMIT
    clipped = jnp.where(beyond, LIMIT / jnp.where(beyond, x, 1.0), x)
    return (jnp.stack([jnp.mean(half) for half in jnp.split(clipped, 2)]) / LIMIT + 1) / 2


def _scaled(value: Callable[[jax.Array], jax.Array]) -> Function:
    """From 0 in the worst corner to 1 at the optimum, as there."""
    worst = value(jnp.full(GENES, -LIMIT))
    return lambda x: (1 - value(x) / worst, _projected(x))


def _sphere(x: jax.Array) -> jax.Array:
    return jnp.sum((x - BEST) ** 2)


def _rastrigin(x: jax.Array) -> jax.Array:
    return jnp.sum(10 + (x - BEST) ** 2 - 10 * jnp.cos(2 * jnp.pi * (x - BEST)))


FUNCTIONS = {"sphere": _scaled(_sphere), "Rastrigin": _scaled(_rastrigin)}

Told = tuple[jax.Array, jax.Array, jax.Array]


def told(function: Function, x: jax.Array) -> Told:
    """Value, place, and rows of derivatives."""
    value, place = function(x)
    by_value, by_place = jax.jacrev(function)(x)
    return value, place, jnp.concatenate([by_value[None], by_place])


def score(fitness: np.ndarray) -> tuple[float, float]:
    """QD score and coverage in percent of what is possible."""
    count = BINS**2
    return 100 * float(np.sum(fitness)) / count, 100 * len(fitness) / count


def ours(function: Function, seed: int) -> np.ndarray:
    """The elites' fitness; our genes run from −1 to 1."""
    axes = tuple(search.Axis(i, 0.0, 1.0, BINS, False) for i in range(2))
    cells, key = search.Grid(axes), jax.random.key(seed)
    emitter = search.emitters.CmaMega(BATCH, newcomer, outputs=3, step=STEP / LIMIT)

    def generation(carry: Any, number: jax.Array) -> tuple[Any, None]:
        archive, state = carry
        children, (state,), _ = search.emitters.emit(
            (emitter,), (state,), archive, neat.first_counters(1, 1), number, key=key
        )
        asked = emitter.asks(state, children)
        assert isinstance(asked, genomes.Vector)
        rows = jax.vmap(lambda genes: told(function, LIMIT * genes)[2])(asked.values)
        slopes = search.Slopes(rows, jnp.ones(1, bool))
        children, state = emitter.learn(state, children, slopes)
        assert isinstance(children.genotypes, genomes.Vector)
        fitness, places = jax.vmap(function)(LIMIT * children.genotypes.values)
        found = search.Elites(
            occupied=jnp.ones(BATCH, bool),
            fitness=fitness,
            measures=places,
            generation=jnp.full(BATCH, number, jnp.int32),
            slot=jnp.arange(BATCH, dtype=jnp.int32),
            genotypes=children.genotypes,
        )
        archive, inserted = search.insert(archive, found, cells)
        outcome = search.Outcome(
            genotypes=found.genotypes,
            fitness=fitness,
            measures=places,
            sound=found.occupied,
            cell=inserted.cell,
            entered=inserted.entered,
            fresh=inserted.fresh,
            improvement=inserted.improvement,
        )
        return (archive, emitter.tell(state, outcome)), None

    nobody = search.no_elites(cells.count, 2, genomes.Vector(jnp.zeros(GENES)))
    first = (nobody, emitter.init(key=key))
    run = jax.jit(lambda carry: jax.lax.scan(generation, carry, jnp.arange(GENERATIONS))[0])
    archive, _ = run(first)
    return np.asarray(archive.fitness)[np.asarray(archive.occupied)]


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Near the middle."""
    return genomes.Vector(0.01 * jax.random.normal(key, (GENES,)))


def qdax(function: Function, seed: int) -> np.ndarray:
    """The elites' fitness by QDax's emitter in its own loop."""
    loop: Any = importlib.import_module("qdax.core.map_elites")
    mega: Any = importlib.import_module("qdax.core.emitters.cma_mega_emitter")

    def scored(x: jax.Array, key: jax.Array) -> tuple[jax.Array, jax.Array, dict]:
        value, place, rows = jax.vmap(lambda one: told(function, one))(x)
        rows = rows / jnp.maximum(jnp.linalg.norm(rows, axis=2, keepdims=True), 1e-30)
        return value, place, {"normalized_grads": jnp.swapaxes(rows, 1, 2)}

    axes = tuple(search.Axis(i, 0.0, 1.0, BINS, False) for i in range(2))
    centroids = jnp.asarray(search.Grid(axes).centres)
    emitter = mega.CMAMEGAEmitter(
        scoring_function=scored,
        batch_size=BATCH,
        learning_rate=1.0,
        num_descriptors=2,
        centroids=centroids,
        sigma_g=STEP,
    )
    search_of = loop.MAPElites(scored, emitter, lambda repertoire: {})
    first_key, init_key, key = jax.random.split(jax.random.PRNGKey(seed), 3)
    first = 0.01 * LIMIT * jax.random.normal(first_key, (BATCH, GENES))
    repertoire, state, _ = search_of.init(first, centroids, init_key)
    run = jax.jit(
        lambda carry: jax.lax.scan(search_of.scan_update, carry, length=GENERATIONS - 1)[0]
    )
    repertoire, _, _ = run((repertoire, state, key))
    fitness = np.asarray(repertoire.fitnesses)[:, 0]
    return fitness[np.isfinite(fitness)]


def pyribs(function: Function, seed: int) -> np.ndarray:
    """The elites' fitness by pyribs, whose authors' algorithm it is."""
    archives: Any = importlib.import_module("ribs.archives")
    emitters: Any = importlib.import_module("ribs.emitters")
    schedulers: Any = importlib.import_module("ribs.schedulers")
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
    slopes = jax.jit(jax.vmap(lambda one: told(function, one)))
    for _ in range(GENERATIONS):
        scheduler.tell_dqd(*(np.array(x) for x in slopes(scheduler.ask_dqd())))
        scheduler.tell(*(np.asarray(x) for x in evaluate(scheduler.ask())))
    return np.asarray(archive.data("objective"))


LIBRARIES = {"microcosmos": ours, "QDax": qdax, "pyribs": pyribs}


def main() -> None:
    title = (
        f"CMA-MEGA, {GENERATIONS:,} generations of {BATCH} in {GENES} dimensions, "
        f"{BINS} × {BINS} cells: median of {len(SEEDS)} seeds (range)"
    )
    table = Table("", "", "QD score, %", "coverage, %", "seconds", title=title)
    for name, function in FUNCTIONS.items():
        for library, run in LIBRARIES.items():
            found = []
            for seed in SEEDS:
                began = time.monotonic()
                found.append((*score(run(function, seed)), time.monotonic() - began))
            table.add_row(
                name, library, *(_median(column) for column in zip(*found, strict=True))
            )
    Console(width=110).print(table)


def _median(values: tuple[float, ...]) -> str:
    return f"{statistics.median(values):.1f} ({min(values):.1f}–{max(values):.1f})"


if __name__ == "__main__":
    main()
