"""Sphere, Rastrigin and arm: our emitters against QDax's MAP-Elites and pyribs' CMA-MAE.

Tasks and settings are those of Fontaine and Nikolaidis (GECCO 2023): 100 genes, 100 × 100
cells, 540 evaluations a generation. Prints tables and asserts nothing. With `--results` each
finished seed is a JSON file, which another call does not repeat.
"""

import argparse
import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import classic_methods
import classic_times
import jax
import jax.numpy as jnp
import loops
import numpy as np
import timing
from classic_tasks import BATCH, BINS, TASKS, Task
from ranking import holm, quartiles, ranks

from microcosmos import device, search

COLUMNS = ("QD score", "coverage, %", "best")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--generations", type=int, default=100)
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS))
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--results", type=Path, help="folder of finished seeds")
    parser.add_argument("--turns", type=int, default=30, help="generations that are timed")
    chosen = parser.parse_args()
    device.prepare()
    packages = {"QDax": timing.installed("qdax"), "pyribs": timing.installed("ribs")}
    methods = [one for one in chosen.methods if packages.get(one.split()[0], True)]
    compare(methods, chosen)
    if chosen.turns:
        classic_times.main(methods, chosen.turns)


def compare(methods: list[str], chosen: argparse.Namespace) -> None:
    """Print scores of all methods, and rank tests of ours against the others."""
    figures: dict[tuple[str, str], np.ndarray] = {}
    for task in chosen.tasks:
        for seed in range(chosen.seeds):
            for method in methods:
                row = measured(task, method, seed, chosen.generations, chosen.results)
                past = figures.get((task, method), np.zeros((0, len(row))))
                figures[task, method] = np.concatenate([past, [row]])
    rows = [(*names, *map(quartiles, values.T)) for names, values in figures.items()]
    evaluations = f"{chosen.generations * BATCH:,} evaluations, {chosen.seeds} seeds"
    title = f"{evaluations}: median (quartiles)"
    timing.print_table(title, ("", "", *COLUMNS, "seconds"), rows)
    print_tests(figures, chosen.tasks)


def print_tests(figures: dict[tuple[str, str], np.ndarray], tasks: list[str]) -> None:
    """Print tests of QD score and coverage, each of our methods against its rival."""
    rows, p_values = [], []
    for task in tasks:
        for ours, theirs in classic_methods.PAIRS.items():
            if not {(task, ours), (task, theirs)} <= figures.keys():
                continue
            for i, name in enumerate(COLUMNS[:2]):
                share, p = ranks(figures[task, ours][:, i], figures[task, theirs][:, i])
                rows.append((task, ours, name, theirs, f"{100 * share:.0f} %", f"{p:.2g}"))
                p_values.append(p)
    corrected = [f"{p:.2g}" for p in holm(p_values)]
    columns = ("", "ours", "of", "against", "greater in", "p", "p, Holm")
    rows = [(*row, p) for row, p in zip(rows, corrected, strict=True)]
    timing.print_table("Two-sided tests of Mann and Whitney", columns, rows)


def measured(
    task: str, method: str, seed: int, generations: int, folder: Path | None
) -> tuple[float, ...]:
    """Return QD score, coverage, best and seconds of a run, from its file if there is one."""
    path = folder and folder / f"{task} {method} {generations} {seed}.json"
    if path and path.exists():
        return tuple(json.loads(path.read_text()).values())
    start = time.monotonic()
    fitness = np.asarray(METHODS[method](TASKS[task], seed, generations), float)
    figures = fitness.sum() / BINS**2, 100 * len(fitness) / BINS**2, fitness.max()
    row = (*map(float, figures), time.monotonic() - start)
    if path:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(dict(zip((*COLUMNS, "seconds"), row, strict=True))))
    return row


def ours(emitter: Callable[[Task], search.Emitter], task: Task, seed: int, many: int) -> Any:
    """Return the elites' fitness in our loop."""
    loop = classic_methods.our_search(emitter(task), task, seed)
    loop.run(task.function, many)
    return loop.elites.fitness


def qdax(task: Task, seed: int, many: int) -> np.ndarray:
    """Return the elites' fitness by QDax's MAP-Elites."""
    scored, emitter, first, centroids = classic_methods.qdax_parts(task)
    return loops.qdax(scored, emitter, first, centroids, many, seed)


def pyribs(task: Task, seed: int, many: int) -> np.ndarray:
    """Return the elites' fitness by pyribs' CMA-MAE, from its archive of results."""
    scheduler, results = classic_methods.pyribs_parts(task, seed)
    evaluate = jax.jit(jax.vmap(task.function))
    for _ in range(many):
        vectors = jnp.asarray(scheduler.ask(), jnp.float32)
        scheduler.tell(*(np.asarray(x) for x in evaluate(vectors)))
    return np.asarray(results.data("objective"))


METHODS: dict[str, Callable] = {
    "iso+line": partial(ours, classic_methods.iso_line),
    "QDax iso+line": qdax,
    "CMA-MAE": partial(ours, classic_methods.cma_mae),
    "pyribs CMA-MAE": pyribs,
}

if __name__ == "__main__":
    main()
