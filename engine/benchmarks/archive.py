"""Archives against QDax's and pyribs': insertion, tessellations, and QD scores of MAP-Elites.

Prints tables and asserts nothing. Rows of one table run interleaved in one process, each
program compiled before. `make peers` installs the other libraries; without them only ours run.
"""

import importlib
import statistics
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing
from functions import FUNCTIONS, ours, qdax

from microcosmos import device, genomes, search

ROWS, GENES = 1_024, 1_000
SIDES = (32, 128)
TURNS = 15
STAGES = {"early in a search, most enter": 4, "late in a search, few enter": 100}
"""Batches before those that are timed."""
CENTROIDS = 16_384
SAMPLES = 50_000
"""Samples for centroids in QDax's examples."""
SEEDS = range(5)


Library = tuple[Callable[[np.ndarray, np.ndarray, np.ndarray], Any], Callable[[Any], object]]
"""Functions that prepare genes, fitness and descriptors (not timed), and insert them."""


def main() -> None:
    device.prepare()
    for side in SIDES:
        for stage in STAGES:
            insertion(side, stage)
    tessellation(CENTROIDS)
    scores()


def insertion(side: int, stage: str) -> None:
    """Print the time to insert a batch of vectors, relative to ours."""
    libraries = {"ours, donated": _ours(side, True), "ours": _ours(side, False)}
    if timing.installed("qdax"):
        libraries |= {"QDax, donated": _qdax(side, True), "QDax": _qdax(side, False)}
    if timing.installed("ribs"):
        libraries["pyribs"] = _ribs(side)
    seconds: dict[str, list[float]] = {name: [] for name in libraries}
    random = np.random.default_rng(0)
    for _ in range(STAGES[stage] + TURNS):
        genes = random.uniform(-1, 1, (ROWS, GENES)).astype(np.float32)
        fitness = random.normal(size=ROWS).astype(np.float32)
        descriptors = random.random((ROWS, 2)).astype(np.float32)
        for name, (prepare, insert) in libraries.items():
            batch = jax.block_until_ready(prepare(genes, fitness, descriptors))
            seconds[name].append(timing.seconds(insert, batch))
    medians = {name: statistics.median(times[-TURNS:]) for name, times in seconds.items()}
    rows = []
    for name, median in medians.items():
        ratio, least = median / medians["ours, donated"], min(seconds[name][-TURNS:])
        rows.append((name, f"{1e3 * median:.2f}", f"{1e3 * least:.2f}", f"{ratio:.2f}"))
    title = f"{ROWS:,} vectors of {GENES:,} genes into {side * side:,} cells of a grid, {stage}"
    timing.print_table(title, ("", "ms", "least", "× ours"), rows)


def tessellation(count: int) -> None:
    """Print the time for centroids of a plane, and the compactness of their cells."""
    methods: dict[str, Callable] = {"ours": lambda: search.cvt.lloyd(count, 2, seed=0)}
    if timing.installed("qdax"):
        peer: Any = importlib.import_module("qdax.core.containers.mapelites_repertoire")
        key, samples = jax.random.PRNGKey(0), max(SAMPLES, count)
        methods["QDax"] = lambda: peer.compute_cvt_centroids(2, samples, count, 0.0, 1.0, key)
    points, rows = np.random.default_rng(9).random((200_000, 2)), []
    for name, method in methods.items():
        centroids: list[np.ndarray] = []
        seconds = timing.seconds(lambda m=method, c=centroids: c.append(np.asarray(m())))
        tree = importlib.import_module("scipy.spatial").cKDTree(centroids[0])
        compact = (tree.query(points)[0] ** 2).mean() * count
        rows.append((name, f"{seconds:.2f}", f"{compact:.4f}"))
    title = f"{count:,} centroids on 2 axes; mean squared distance in areas of a cell"
    timing.print_table(title, ("", "s", "compactness (hexagons 0.1604)"), rows)


def scores() -> None:
    """Print the QD score of MAP-Elites on plain functions, ours and QDax's."""
    libraries = {"ours": ours} | ({"QDax": qdax} if timing.installed("qdax") else {})
    rows = []
    for name in FUNCTIONS:
        columns = ([run(name, seed) for seed in SEEDS] for run in libraries.values())
        rows.append((name, *map(timing.median_range, columns)))
    title = f"QD score above the function's least value: median of {len(SEEDS)} seeds (range)"
    timing.print_table(title, ("", *libraries), rows)


def _ours(side: int, donate: bool) -> Library:
    axes = tuple(search.Axis(i, 0.0, 1.0, side, False) for i in range(2))
    grid, program = search.Grid(axes), search.insert_program(donate=donate)
    archive = [search.no_elites(grid.count, 2, genomes.Vector(jnp.zeros(GENES)))]

    def prepare(genes: np.ndarray, *measured: np.ndarray) -> search.Elites:
        vectors, feasible = genomes.Vector(jnp.asarray(genes)), jnp.ones(ROWS, bool)
        fitness, descriptors = map(jnp.asarray, measured)
        return search.candidates(0, vectors, fitness, descriptors, feasible)

    def insert(rows: search.Elites) -> object:
        archive[0], inserted = program(archive[0], rows, grid)
        return archive[0], inserted

    return prepare, insert


def _qdax(side: int, donate: bool) -> Library:
    peer: Any = importlib.import_module("qdax.core.containers.mapelites_repertoire")
    centroids = peer.compute_euclidean_centroids((side, side), 0.0, 1.0)
    archive = [peer.MapElitesRepertoire.init_default(jnp.zeros(GENES), centroids)]
    program = jax.jit(
        lambda repertoire, genes, fitness, places: repertoire.add(genes, places, fitness),
        donate_argnums=(0,) if donate else (),
    )

    def insert(batch: Any) -> object:
        archive[0] = program(archive[0], *batch)
        return archive[0]

    return lambda *batch: jax.device_put(batch), insert


def _ribs(side: int) -> Library:
    peer: Any = importlib.import_module("ribs.archives")
    options = {"dims": (side, side), "ranges": [(0, 1)] * 2, "dtype": np.float32}
    archive = peer.GridArchive(solution_dim=GENES, **options)
    return lambda *batch: batch, lambda batch: archive.add(*batch) and None


if __name__ == "__main__":
    main()
