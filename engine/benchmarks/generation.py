"""Time of a generation besides its rollouts.

Children, insertion, learning, names and lineage against the evaluation of a batch, in the
standard search and in NEAT alone, as `make acceptance` runs them.
"""

import statistics
import time

import jax
import timing

from microcosmos.build import build
from microcosmos.device import prepare
from microcosmos.spec import parse

WARM, TIMED = 3, 8
"""Generations that compile and warm up, and those that are timed."""

SEARCHES = {
    "MAP-Elites, NEAT": {"experiment": "quality-diversity"},
    "NEAT": {"experiment": "neuroevolution", "search": {"batch": 64}},
    "MAP-Elites, iso+line, direct": {
        "experiment": "quality-diversity",
        "control": {"encoding": "direct"},
        "search": {"emitters": [{"operator": "iso+line"}]},
    },
}


def generations(document: dict) -> list[tuple[float, float]]:
    """Seconds of each timed generation, and of its rollouts."""
    run = build(parse(document))
    state, seconds = run.init(), []
    for _ in range(WARM + TIMED):
        start = time.monotonic()
        state, report = run.advance(state)
        whole = time.monotonic() - start
        rollouts = float((report.summary or {})["device_seconds"] or 0.0)
        seconds.append((whole, rollouts / jax.local_device_count()))
    return seconds[WARM:]


def main() -> None:
    prepare()
    rows = []
    for name, document in SEARCHES.items():
        seconds = generations(document)
        whole, rollouts = (statistics.median(column) for column in zip(*seconds, strict=True))
        rest = statistics.median(a - b for a, b in seconds)
        share = statistics.median((a - b) / a for a, b in seconds)
        rows.append((name, f"{whole:.3f}", f"{rollouts:.3f}", f"{rest:.4f}", f"{share:.1%}"))
    columns = ("", "whole", "rollouts", "the rest", "share (bar 8 %)")
    timing.print_table("Median seconds of a generation of 64 creatures", columns, rows)


if __name__ == "__main__":
    main()
