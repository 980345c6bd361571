"""Times of `ask` and `tell`, ours beside QDax's and pyribs', on the tasks of `classic`."""

import importlib
import statistics
from collections.abc import Callable
from typing import Any

import classic_methods
import jax
import jax.numpy as jnp
import numpy as np
import timing
from classic_tasks import BATCH, TASKS, Task

from microcosmos import search

Step = Callable[[], tuple[float, float]]
"""A function that advances by a generation; seconds of ask and tell."""
WARM = 20
"""Generations before those that are timed."""


def main(methods: list[str], turns: int) -> None:
    """Print times on the sphere; the methods take turns in one process."""
    task = TASKS["sphere"]
    steps = {name: STEPS[name](task) for name in methods}
    seconds: dict[str, list[tuple[float, float]]] = {name: [] for name in methods}
    for _ in range(WARM + turns):
        for name, step in steps.items():
            seconds[name].append(step())
    medians = {
        name: [1e3 * statistics.median(part) for part in zip(*times[WARM:], strict=True)]
        for name, times in seconds.items()
    }
    rows = []
    for name, (ask, tell) in medians.items():
        rival = sum(medians.get(classic_methods.PAIRS.get(name, ""), ()))
        ratio = f"{rival / (ask + tell):.1f}" if rival else ""
        rows.append((name, f"{ask:.2f}", f"{tell:.2f}", f"{ask + tell:.2f}", ratio))
    title = f"ms of a generation of {BATCH} without evaluation: median of {turns}"
    columns = ("", "ask", "tell", "both", "the other's, × ours")
    timing.print_table(title, columns, rows)


def ours(emitter: Callable[[Task], search.Emitter], task: Task) -> Step:
    loop, evaluate = classic_methods.our_search(emitter(task), task, 0), _evaluation(task)

    def step() -> tuple[float, float]:
        asked: list[Any] = []
        ask = timing.seconds(lambda: asked.append(loop.ask()))
        found = evaluate(asked[0])
        return ask, timing.seconds(lambda: loop.tell(*found))

    return step


def qdax(task: Task) -> Step:
    """Time QDax's emitter and archive as compiled programs; its `tell` is insertion alone."""
    peer: Any = importlib.import_module("qdax.core.containers.mapelites_repertoire")
    scored, emitter, first, centroids = classic_methods.qdax_parts(task)
    vectors = first(jax.random.PRNGKey(0))
    fitness, places, _ = scored(vectors, None)
    state = [peer.MapElitesRepertoire.init(vectors, fitness, places, centroids)]
    emit = jax.jit(lambda repertoire, key: emitter.emit(repertoire, None, key)[0])
    add = jax.jit(lambda repertoire, *rows: repertoire.add(*rows), donate_argnums=0)
    keys = iter(jax.random.split(jax.random.PRNGKey(1), 10_000))
    evaluate = jax.jit(scored)

    def insert(*rows: jax.Array) -> object:
        state[0] = add(state[0], *rows)
        return state[0]

    def step() -> tuple[float, float]:
        key, asked = next(keys), []
        ask = timing.seconds(lambda: asked.append(emit(state[0], key)) or asked[0])
        fitness, places, _ = jax.block_until_ready(evaluate(asked[0], key))
        return ask, timing.seconds(insert, asked[0], places, fitness)

    return step


def pyribs(task: Task) -> Step:
    (scheduler, _), evaluate = classic_methods.pyribs_parts(task, 0), _evaluation(task)

    def step() -> tuple[float, float]:
        asked: list[Any] = []
        ask = timing.seconds(lambda: asked.append(scheduler.ask()))
        found = evaluate(asked[0])
        return ask, timing.seconds(lambda: scheduler.tell(*found) and None)

    return step


def _evaluation(task: Task) -> Callable[[np.ndarray], list[np.ndarray]]:
    program = jax.jit(jax.vmap(task.function))
    return lambda x: [np.asarray(one) for one in program(jnp.asarray(x, jnp.float32))]


STEPS: dict[str, Callable[[Task], Step]] = {
    "iso+line": lambda task: ours(classic_methods.iso_line, task),
    "QDax iso+line": qdax,
    "CMA-MAE": lambda task: ours(classic_methods.cma_mae, task),
    "pyribs CMA-MAE": pyribs,
}
