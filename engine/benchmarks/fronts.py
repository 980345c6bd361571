"""Pareto fronts in cells: our `Fronts` against QDax's MOME on Rastrigin with two optima.

Both search by iso+line at equal settings and evaluations. Prints a table and asserts nothing.
"""

import argparse
import importlib
from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing
from ranking import quartiles, ranks

from microcosmos import device, genomes, search

GENES, CELLS, BATCH = 100, 64, 100
LOW, HIGH, OPTIMA = -2.0, 4.0, (0.0, 2.2)
ISO, LINE = 0.06, 0.1
WORST = 40.0
"""A bound of a gene's part of the function."""

Scores = tuple[np.ndarray, np.ndarray]
"""Cells and both objectives of all elites."""


def rastrigin(x: jax.Array) -> jax.Array:
    """Return both objectives, nearness to either optimum, from 0 to 1."""
    z = x[None] - jnp.asarray(OPTIMA)[:, None]
    parts = 10 + z * z - 10 * jnp.cos(2 * jnp.pi * z)
    return 1 - jnp.mean(parts, 1) / WORST


def cells() -> search.Voronoi:
    """Return the cells over the first two genes, the same for both libraries."""
    axes = tuple(search.Axis(i, LOW, HIGH, 1) for i in range(2))
    return search.voronoi(axes, search.cvt.centroids(CELLS, 2, seed=0))


def newcomer(*, key: jax.Array) -> genomes.Vector:
    """Return uniform genes."""
    return genomes.Vector(jax.random.uniform(key, (GENES,), minval=-1.0, maxval=1.0))


def measured(genes: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the first objective, and descriptors and the second objective."""
    x = (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * genes
    first, second = rastrigin(x)
    return first, jnp.stack([x[0], x[1], second])


def ours(seed: int, generations: int, length: int) -> Scores:
    second = search.Axis(2, 0.0, 1.0, 1)
    fronts = search.Fronts(cells(), second, length, least=False)
    emitter = search.emitters.IsoLine(BATCH, newcomer, 2 * ISO / (HIGH - LOW), LINE)
    loop = search.Search(search.Vectors(GENES), fronts, [emitter], seed=seed)
    loop.run(measured, generations)
    elites = loop.elites
    both = np.stack([elites.fitness, elites.measures[:, 2]], 1)
    return np.asarray(fronts.cells.of(jnp.asarray(elites.measures))), both


def qdax(seed: int, generations: int, length: int, *, alike: bool = False) -> Scores:
    """Search by QDax's MOME; `alike` draws each elite with the same chance, as ours does."""
    mome: Any = importlib.import_module("qdax.core.mome")
    standard: Any = importlib.import_module("qdax.core.emitters.standard_emitters")
    operators: Any = importlib.import_module("qdax.core.emitters.mutation_operators")
    variation = partial(
        operators.isoline_variation, iso_sigma=ISO, line_sigma=LINE, minval=LOW, maxval=HIGH
    )
    chosen = _Alike() if alike else None
    emitter = standard.MixingEmitter(lambda x, key: x, variation, 1.0, BATCH, chosen)
    loop = mome.MOME(_scored, emitter, lambda repertoire: {}, length)
    first_key, init_key, key = jax.random.split(jax.random.PRNGKey(seed), 3)
    first = jax.random.uniform(first_key, (BATCH, GENES), minval=LOW, maxval=HIGH)
    repertoire, state, _ = loop.init(first, LOW + (HIGH - LOW) * cells().centroids, init_key)
    run = jax.jit(
        lambda carry: jax.lax.scan(loop.scan_update, carry, length=generations - 1)[0]
    )
    repertoire, _, _ = run((repertoire, state, key))
    there = np.isfinite(np.asarray(repertoire.fitnesses)).all(2)
    return np.nonzero(there)[0], np.asarray(repertoire.fitnesses)[there]


class _Alike:
    """A selector of QDax that draws uniformly among all elites of fronts."""

    def select(self, repertoire: Any, key: jax.Array, count: int) -> Any:
        fitness = repertoire.fitnesses
        flat = jax.tree.map(
            lambda x: x.reshape(-1, *x.shape[2:]),
            repertoire.replace(centroids=jnp.zeros((*fitness.shape[:2], 1))),
        )
        chances = jnp.all(jnp.isfinite(flat.fitnesses), 1).astype(jnp.float32)
        rows = jax.random.choice(key, len(chances), (count,), p=chances / jnp.sum(chances))
        return jax.tree.map(lambda x: x[rows], flat)


def _scored(vectors: jax.Array, key: Any) -> tuple[jax.Array, jax.Array, dict]:
    return jax.vmap(rastrigin)(vectors), vectors[:, :2], {}


METHODS: dict[str, Callable[[int, int, int], Scores]] = {
    "ours": ours,
    "QDax": qdax,
    "QDax, elites drawn alike": partial(qdax, alike=True),
}
COLUMNS = ("MOQD score", "hypervolume, %", "largest sum", "mean length")


def figures(cell: np.ndarray, both: np.ndarray) -> tuple[float, ...]:
    """Return the figures of `COLUMNS`; the reference point is (0, 0)."""
    first, second = both.astype(float).T
    return (
        search.hypervolume(cell, first, second),
        100 * search.hypervolume(np.zeros_like(cell), first, second),
        float(np.max(first + second)),
        len(cell) / len(np.unique(cell)),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--generations", type=int, default=200)
    parser.add_argument("--lengths", type=int, nargs="+", default=[50, 8])
    chosen = parser.parse_args()
    device.prepare()
    methods = METHODS if timing.installed("qdax") else {"ours": ours}
    for length in chosen.lengths:
        found: dict[str, np.ndarray] = {}
        for name, method in methods.items():
            runs = (method(seed, chosen.generations, length) for seed in range(chosen.seeds))
            found[name] = np.array([figures(*scores) for scores in runs])
        title = (
            f"Fronts of at most {length}: {chosen.generations * BATCH:,} evaluations, "
            f"{chosen.seeds} seeds, median (quartiles)"
        )
        lines = [
            (name, *map(quartiles, rows.T), _test(found, name)) for name, rows in found.items()
        ]
        timing.print_table(title, ("", *COLUMNS, "ours greater"), lines)


def _test(found: dict[str, np.ndarray], name: str) -> str:
    """Return the share of pairs in which our MOQD score is greater, and p of a rank test."""
    if name == "ours":
        return ""
    share, p = ranks(found["ours"][:, 0], found[name][:, 0])
    return f"{100 * share:.0f} %, p = {p:.2g}"


if __name__ == "__main__":
    main()
