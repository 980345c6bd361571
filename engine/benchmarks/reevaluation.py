"""Means that decide against single values, at equal simulations, in the preset `standard`.

Each final archive is tested by samples that no search has seen, outside its budget. Prints a
table and asserts nothing.
"""

import argparse
from dataclasses import replace
from typing import Any

import numpy as np
import timing

from microcosmos import device, spec
from microcosmos.build import build
from microcosmos.experiments import reevaluation
from microcosmos.experiments.evolution import Evolution
from microcosmos.search import never

NEVER = 10**6
"""A generation that no search here reaches."""
ARMS: dict[str, dict[str, Any] | None] = {
    "single values": None,
    "means of at least 2": {"decides": True, "samples": 2},
    "means of at least 4": {"decides": True, "samples": 4},
}
COLUMNS = (
    "generations",
    "QD score",
    "coverage, %",
    "corrected QD score",
    "corrected coverage, %",
    "hit rate, %",
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--evaluations", type=int, default=2560)
    parser.add_argument("--samples", type=int, default=8, help="of each elite in the test")
    chosen = parser.parse_args()
    device.prepare()
    rows = []
    for name, options in ARMS.items():
        found = [
            scores(options, seed, chosen.evaluations, chosen.samples)
            for seed in range(chosen.seeds)
        ]
        rows.append((name, *(spread(column) for column in zip(*found, strict=True))))
    title = f"{chosen.evaluations:,} simulations, {chosen.seeds} seeds: median (range)"
    timing.print_table(title, ("", *COLUMNS), rows)


def scores(
    options: dict[str, Any] | None, seed: int, evaluations: int, samples: int
) -> tuple[float, ...]:
    """Return the figures of `COLUMNS` for one search."""
    search = {"generations": NEVER, "stop": {"evaluations": evaluations}}
    tested = {"every": NEVER, "samples": samples}
    decides = options and {**options, "every": NEVER}
    test, plain = (
        build(
            spec.QualityDiversity.model_validate(
                {"seed": seed, "search": search | {"reevaluation": part}}
            )
        )
        for part in (tested, decides)
    )
    assert isinstance(plain, Evolution)
    assert isinstance(test, Evolution)
    assert test.repeats
    experiment = replace(plain, repeats=None)
    state = experiment.init()
    while not experiment.done(state):
        state, _ = experiment.advance(state)
    occupied = np.asarray(state.elites.occupied)
    score = float(np.asarray(state.elites.fitness)[occupied].sum())
    again = replace(state, generation=NEVER + 1)
    again = reevaluation.evaluate(test.plan, test.repeats, test.devices, again, never)
    corrected, coverage, hits = reevaluation.figures(test.repeats, again)
    shares = (100 * occupied.mean(), corrected, 100 * coverage, 100 * hits)
    return (state.generation, score, *shares)


def spread(values: tuple[float, ...]) -> str:
    return f"{np.median(values):.3g} ({min(values):.3g}–{max(values):.3g})"


if __name__ == "__main__":
    main()
