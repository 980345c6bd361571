"""Learned axes on a planar arm: our container against QDax's AURORA, with one encoder.

Both learn principal components of the places of all joints, in the same generations, and vary
by iso+line. Their last populations are placed in the same grid of the end's place. Prints a
table and asserts nothing.
"""

import argparse
import importlib
import time
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing
from ranking import ranks

from microcosmos import device, search
from microcosmos.archive import components

JOINTS, BATCH, BINS, FIRST = 20, 128, 16, 10
ISO, LINE = 0.01, 0.1
"""Deviations for genes from 0 to 1, as QDax has them; ours run from −1 to 1."""
LEAST = -0.5
"""Lower bound of fitness, so that every elite adds to the score."""
ROOM, RADIUS = 2 * BINS**2, 0.45
"""QDax's places, of which half are asked for, and its first distance between elites."""
CONTROLLED = 10
"""Generations between two changes of that distance, which sort all pairs of places."""
COLUMNS = ("coverage, %", "QD score", "elites", "seconds")


def arm(genes: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return the fitness of genes from 0 to 1, and the places of the end and of all joints.

    Cully et al., Nature 521, 503 (2015), in the form of fast_map_elites.
    """
    angle = jnp.cumsum(2 * jnp.pi * genes - jnp.pi)
    joints = [jnp.cumsum(part(angle)) / JOINTS for part in (jnp.cos, jnp.sin)]
    end = jnp.stack([(one[-1] + 1) / 2 for one in joints])
    return -jnp.std(genes), jnp.concatenate([end, *joints])


def of_ours(genes: jax.Array) -> tuple[jax.Array, jax.Array]:
    fitness, measures = arm((genes + 1) / 2)
    return fitness - LEAST, measures


GRID = search.Grid(tuple(search.Axis(i, 0.0, 1.0, BINS) for i in range(2)))


def ours(seed: int, generations: int, *, learned: bool) -> np.ndarray:
    """Return coverage, QD score and number of elites in our loop."""
    space = search.Vectors(JOINTS, -1.0, 1.0)
    joints = tuple(range(2, 2 + 2 * JOINTS))
    axes = search.learned_axes(GRID, joints, bins=BINS, first=FIRST)
    line = search.emitters.IsoLine(BATCH, space, 2 * ISO, LINE)
    container = axes if learned else GRID
    loop = search.Search(space, container, [line], seed=seed, measures=2 + len(joints))
    loop.run(of_ours, generations)
    return np.array([100 * loop.coverage, loop.qd_score, len(loop.elites.fitness)])


def qdax(seed: int, generations: int) -> np.ndarray:
    """Return the same of QDax's AURORA, with our components as its encoder."""
    aurora: Any = importlib.import_module("qdax.core.aurora")
    standard: Any = importlib.import_module("qdax.core.emitters.standard_emitters")
    operators: Any = importlib.import_module("qdax.core.emitters.mutation_operators")
    types: Any = importlib.import_module("qdax.custom_types")
    deviations = {"iso_sigma": ISO, "line_sigma": LINE, "minval": 0.0, "maxval": 1.0}
    variation = partial(operators.isoline_variation, **deviations)
    emitter = standard.MixingEmitter(lambda x, key: x, variation, 1.0, BATCH)

    def scored(genes: jax.Array, key: Any) -> tuple[jax.Array, jax.Array, dict]:
        fitness, measures = jax.vmap(arm)(genes)
        return fitness, measures[:, :2], {"observations": measures[:, 2:]}

    def encoded(rows: jax.Array, info: Any) -> jax.Array:
        known = info.model_params
        apart = (rows - known["mean"][None]) / known["scale"][None]
        return jnp.clip(apart, -components.CLIP, components.CLIP) @ known["weights"].T

    def trained(repertoire: Any, params: Any, number: int, rows: jax.Array, key: Any) -> Any:
        there = np.isfinite(np.asarray(repertoire.fitnesses)[:, 0])
        found = components.learn(np.asarray(rows)[there], 2)
        known = {"mean": found.mean, "weights": found.weights}
        known["scale"] = np.where(found.scale > 0, found.scale, 1.0)
        known = {name: jnp.asarray(one, jnp.float32) for name, one in known.items()}
        return types.AuroraExtraInfo(model_params=known)

    loop = aurora.AURORA(scored, emitter, lambda repertoire: {}, encoded, trained)
    first, start, key = jax.random.split(jax.random.PRNGKey(seed), 3)
    genes = jax.random.uniform(first, (BATCH, JOINTS))
    _, measures = jax.vmap(arm)(genes)
    empty = argparse.Namespace(fitnesses=np.zeros((BATCH, 1)))
    info = trained(empty, None, 0, measures[:, 2:], None)
    repertoire, state, _, info = loop.init(genes, info, jnp.asarray(RADIUS), ROOM, start)
    error: Any = jnp.sum(repertoire.fitnesses != -jnp.inf) - BINS**2
    update, control = jax.jit(loop.update), jax.jit(loop.container_size_control)
    schedule = search.learned_axes(GRID, (0, 1), first=FIRST)
    schedule = schedule.with_arrays({**schedule.arrays(), "epoch": 1})
    for number in range(2, generations + 1):
        key, use = jax.random.split(key)
        repertoire, state, _ = update(repertoire, state, use, info)
        if number % CONTROLLED == 0:
            repertoire, error = control(repertoire, BINS**2, error)
        if schedule.changes(number):
            repertoire, info = loop.train(repertoire, info.model_params, number, use)
    there = np.isfinite(np.asarray(repertoire.fitnesses)[:, 0])
    return _figures(np.asarray(repertoire.genotypes)[there])


def _figures(genes: np.ndarray) -> np.ndarray:
    """Return coverage, QD score and number of elites of a population."""
    fitness, measures = jax.vmap(arm)(jnp.asarray(genes))
    best = np.full(GRID.count, -np.inf)
    np.maximum.at(best, np.asarray(GRID.of(measures)), np.asarray(fitness) - LEAST)
    occupied = np.isfinite(best)
    return np.array([100 * occupied.mean(), best[occupied].sum(), len(genes)])


METHODS = {
    "ours, learned axes": partial(ours, learned=True),
    "QDax, AURORA": qdax,
    "ours, the place of the end": partial(ours, learned=False),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--generations", type=int, default=200)
    chosen = parser.parse_args()
    device.prepare()
    methods = [one for one in METHODS if "QDax" not in one or timing.installed("qdax")]
    figures: dict[str, list[np.ndarray]] = {name: [] for name in methods}
    for seed in range(chosen.seeds):
        for name in methods:
            begun = time.monotonic()
            row = METHODS[name](seed, chosen.generations)
            figures[name].append(np.append(row, time.monotonic() - begun))
            print(seed, name, *(f"{figure:.2f}" for figure in figures[name][-1]), flush=True)
    rows = [
        (name, *(timing.median_range(column) for column in np.transpose(values).tolist()))
        for name, values in figures.items()
    ]
    evaluations = f"{chosen.generations * BATCH:,} evaluations, {chosen.seeds} seeds"
    timing.print_table(f"{evaluations}: median (range)", ("", *COLUMNS), rows)
    if len(methods) < len(METHODS):
        return
    mine, theirs = (np.array(values) for values in list(figures.values())[:2])
    for i, name in enumerate(COLUMNS[:2]):
        share, p = ranks(mine[:, i], theirs[:, i])
        print(f"{name}: {methods[0]} above {methods[1]} in {100 * share:.0f} %, p = {p:.2g}")


if __name__ == "__main__":
    main()
