"""Time of a generation besides its rollouts.

Children, selection, screening, insertion, learning, names and lineage against the evaluation of
a batch: in the standard search and in NEAT alone, as `make acceptance` runs them, and where the
archive is large and full.
"""

import statistics
import time
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import timing

from microcosmos import search
from microcosmos.build import build
from microcosmos.device import prepare
from microcosmos.experiments.evolution import Evolution
from microcosmos.search.loop import State
from microcosmos.spec import parse

WARM, TIMED = 3, 8
"""Generations that compile and warm up, and those that are timed."""

QD = {"experiment": "quality-diversity"}
SEARCHES: dict[str, dict[str, Any]] = {
    "MAP-Elites, NEAT": QD,
    "NEAT": {"experiment": "neuroevolution", "search": {"batch": 64}},
    "MAP-Elites, iso+line, direct": QD
    | {"control": {"encoding": "direct"}, "search": {"emitters": [{"operator": "iso+line"}]}},
    "MAP-Elites, NEAT, screened": QD | {"search": {"screening": {}}},
}
SIDE = 320
"""Bins along each axis of the large archive."""
LARGE = {
    "descriptors": [{"name": name, "bins": SIDE} for name in ("symmetry", "curvature_mean")]
}
FULL = ("MAP-Elites, NEAT", "MAP-Elites, NEAT, screened")
"""Searches that are also timed with a large archive whose cells are all occupied."""


def filled(run: Evolution, state: State) -> State:
    """Return the state with an elite in every cell: varied newcomers, which are no swimmers."""
    plan, encoding, random = run.plan, run.facts.encoding, np.random.default_rng(0)
    count = plan.cell_count
    keys = jax.random.split(jax.random.key(1), count)
    newcomer = jax.jit(jax.vmap(lambda key: encoding.newcomer(key=key)))
    parts = [jax.device_get(newcomer(keys[i : i + 4096])) for i in range(0, count, 4096)]
    measures = random.random((count, len(plan.measures))).astype(np.float32)
    for axis, place in zip(plan.axes, search.cells_of(plan.container).centres.T, strict=True):
        measures[:, axis.measure] = np.asarray(axis.value(jnp.asarray(place)))
    elites = replace(
        state.elites,
        occupied=jnp.ones(count, bool),
        fitness=jnp.asarray(random.random(count) * 0.6, jnp.float32),
        measures=jnp.asarray(measures),
        curiosity=jnp.ones(count, jnp.float32),
        genotypes=jax.tree.map(lambda *rows: jnp.asarray(np.concatenate(rows)), *parts),
    )
    creatures = random.integers(1, 256, (count, 32)).astype(np.uint8)
    lineage = replace(state.parts["lineage"], creatures=creatures)
    return replace(state, elites=elites, parts={**state.parts, "lineage": lineage})


def generations(document: dict[str, Any], full: bool) -> list[tuple[float, float]]:
    """Return the seconds of each timed generation, and of its rollouts."""
    run = build(parse(document | ({"archive": LARGE} if full else {})))
    assert isinstance(run, Evolution)
    rollouts = [0.0]

    class Timed(search.LocalDevices):
        def evaluate(self, program: Any, *given: Any, **options: Any) -> Any:
            start = time.monotonic()
            found = super().evaluate(program, *given, **options)
            if program is run.plan.programs["offspring"].run:
                rollouts[0] += time.monotonic() - start
            return found

    state, seconds = run.init(), []
    if full:
        state = filled(run, state)
    timed = replace(run, devices=Timed())
    for _ in range(WARM + TIMED):
        rollouts[0], start = 0.0, time.monotonic()
        state, _ = timed.advance(state)
        seconds.append((time.monotonic() - start, rollouts[0]))
    return seconds[WARM:]


def main() -> None:
    prepare()
    rows = []
    cases = [(name, False) for name in SEARCHES] + [(name, True) for name in FULL]
    for name, full in cases:
        seconds = generations(SEARCHES[name], full)
        whole, rollouts = (statistics.median(column) for column in zip(*seconds, strict=True))
        rest = statistics.median(a - b for a, b in seconds)
        share = statistics.median((a - b) / a for a, b in seconds)
        name = f"{name}, {SIDE * SIDE:,} elites" if full else name
        rows.append((name, f"{whole:.3f}", f"{rollouts:.3f}", f"{rest:.4f}", f"{share:.1%}"))
    columns = ("", "whole", "rollouts", "the rest", "share (bar 8 %)")
    timing.print_table("Median seconds of a generation of 64 creatures", columns, rows)


if __name__ == "__main__":
    main()
