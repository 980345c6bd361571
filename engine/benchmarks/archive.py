"""Archives beside QDax's and pyribs': insertion, tessellations, and what MAP-Elites reaches.

Prints tables and asserts nothing. Rows of one table run interleaved in one process, each
program compiled before. Peers are compared with where they are installed: `make peers`.
"""

import importlib
import importlib.util
import os
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import loops
import numpy as np
from functions import FUNCTIONS, ours, theirs

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


@dataclass(frozen=True)
class Peer:
    """An archive, and the ways to prepare and insert a batch."""

    pack: Callable[[np.ndarray, np.ndarray, np.ndarray], Any]
    """Prepare genes, fitness and places; not timed."""
    add: Callable[[Any], object]
    """Insert the batch; return a value to wait for."""


def main() -> None:
    """All tables."""
    device.prepare()
    sides = SIDES[:1] if os.environ.get("SMALL") else SIDES
    for side in sides:
        for stage in STAGES:
            insertion(side, stage)
    tessellation(1_024 if os.environ.get("SMALL") else CENTROIDS)
    reached()


def insertion(side: int, stage: str) -> None:
    """Print the time to insert a batch of vectors, ours as 1."""
    peers = {"ours, donated": _ours(side, donate=True), "ours": _ours(side, donate=False)}
    if installed("qdax"):
        peers |= {"QDax, donated": _qdax(side, donate=True), "QDax": _qdax(side, donate=False)}
    if installed("ribs"):
        peers["pyribs"] = _ribs(side)
    seconds: dict[str, list[float]] = {name: [] for name in peers}
    random = np.random.default_rng(0)
    for turn in range(STAGES[stage] + TURNS):
        genes = random.uniform(-1, 1, (ROWS, GENES)).astype(np.float32)
        fitness = random.normal(size=ROWS).astype(np.float32)
        places = random.random((ROWS, 2)).astype(np.float32)
        for name, peer in peers.items():
            given = jax.block_until_ready(peer.pack(genes, fitness, places))
            taken = loops.seconds(peer.add, given)
            if turn >= STAGES[stage]:
                seconds[name].append(taken)
    print(
        f"\n{ROWS:,} vectors of {GENES:,} genes into {side * side:,} cells of a grid, {stage}"
    )
    print_times(seconds, "ours, donated")


def print_times(seconds: dict[str, list[float]], first: str) -> None:
    """Print medians and their ratios."""
    reference = statistics.median(seconds[first])
    for name, taken in seconds.items():
        median, least = statistics.median(taken), min(taken)
        times = f"{1e3 * median:10.2f} ms, least {1e3 * least:10.2f}"
        print(f"  {name:16s} {times}   {median / reference:9.2f} ×")


def tessellation(count: int) -> None:
    """Print the time for centroids of a plane, and how compact their cells are."""
    print(f"\n{count:,} centroids on 2 axes; mean squared distance in areas of a cell")
    began = time.perf_counter()
    found = search.cvt.lloyd(count, 2, seed=0)
    _told("ours", time.perf_counter() - began, found)
    if installed("qdax"):
        repertoires = importlib.import_module("qdax.core.containers.mapelites_repertoire")
        began = time.perf_counter()
        key = jax.random.PRNGKey(0)
        found = repertoires.compute_cvt_centroids(2, max(SAMPLES, count), count, 0.0, 1.0, key)
        _told("QDax", time.perf_counter() - began, np.asarray(found))


def reached() -> None:
    """Print the QD score of MAP-Elites on plain functions, ours and QDax's."""
    print(f"\nQD score above the function's least value: median (range) of {len(SEEDS)} seeds")
    for name in FUNCTIONS:
        line = f"  {name:10s} ours {_range([ours(name, seed) for seed in SEEDS])}"
        if installed("qdax"):
            line += f"   QDax {_range([theirs(name, seed) for seed in SEEDS])}"
        print(line, flush=True)


def installed(package: str) -> bool:
    """Whether a peer is installed; print it if not."""
    if importlib.util.find_spec(package):
        return True
    print(f"  ({package} is not installed: make peers)")
    return False


def _ours(side: int, *, donate: bool) -> Peer:
    axes = tuple(search.Axis(i, 0.0, 1.0, side, False) for i in range(2))
    grid, insert = search.Grid(axes), search.insert_program(donate=donate)
    kept = [search.no_elites(grid.count, 2, genomes.Vector(jnp.zeros(GENES)))]

    def pack(genes: np.ndarray, fitness: np.ndarray, places: np.ndarray) -> search.Elites:
        vectors, feasible = genomes.Vector(jnp.asarray(genes)), jnp.ones(ROWS, bool)
        return search.candidates(
            0, vectors, jnp.asarray(fitness), jnp.asarray(places), feasible
        )

    def add(rows: search.Elites) -> object:
        kept[0], inserted = insert(kept[0], rows, grid)
        return kept[0], inserted

    return Peer(pack, add)


def _qdax(side: int, *, donate: bool) -> Peer:
    peer: Any = importlib.import_module("qdax.core.containers.mapelites_repertoire")
    centroids = peer.compute_euclidean_centroids((side, side), 0.0, 1.0)
    kept = [peer.MapElitesRepertoire.init_default(jnp.zeros(GENES), centroids)]
    program = jax.jit(
        lambda repertoire, genes, places, fitness: repertoire.add(genes, places, fitness),
        donate_argnums=(0,) if donate else (),
    )

    def add(given: Any) -> object:
        genes, fitness, places = given
        kept[0] = program(kept[0], genes, places, fitness)
        return kept[0]

    return Peer(lambda *given: jax.device_put(given), add)


def _ribs(side: int) -> Peer:
    peer: Any = importlib.import_module("ribs.archives")
    archive = peer.GridArchive(
        solution_dim=GENES, dims=(side, side), ranges=[(0, 1)] * 2, dtype=np.float32
    )
    return Peer(
        lambda *given: given,
        lambda given: archive.add(given[0], given[1], given[2]) and None,
    )


def _told(name: str, seconds: float, centroids: np.ndarray) -> None:
    places = np.random.default_rng(9).random((200_000, 2))
    tree = importlib.import_module("scipy.spatial").cKDTree(centroids)
    compact = (tree.query(places)[0] ** 2).mean() * len(centroids)
    print(f"  {name:16s} {seconds:8.2f} s   {compact:.4f} (hexagons 0.1604)", flush=True)


def _range(values: list[float]) -> str:
    return f"{statistics.median(values):.1f} ({min(values):.1f} to {max(values):.1f})"


if __name__ == "__main__":
    sys.exit(main())
