"""Time of a generation besides its rollouts.

The standard search and NEAT alone, as `make acceptance` runs them: children, insertion, what
emitters learn, names and lineage, against the evaluation of a batch.
"""

import statistics
import time

import jax
from rich.console import Console
from rich.table import Table

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
    state, found = run.init(), []
    for _ in range(WARM + TIMED):
        began = time.monotonic()
        state, report = run.advance(state)
        whole = time.monotonic() - began
        spent = float((report.summary or {})["device_seconds"] or 0.0)
        found.append((whole, spent / jax.local_device_count()))
    return found[WARM:]


def main() -> None:
    prepare()
    title = "Median seconds of a generation of 64 creatures"
    table = Table("", "whole", "rollouts", "the rest", "share (bar 2 %)", title=title)
    for name, document in SEARCHES.items():
        found = generations(document)
        whole, rollouts = (statistics.median(column) for column in zip(*found, strict=True))
        rest = statistics.median(a - b for a, b in found)
        share = statistics.median((a - b) / a for a, b in found)
        row = (f"{whole:.3f}", f"{rollouts:.3f}", f"{rest:.4f}", f"{share:.1%}")
        table.add_row(name, *row)
    Console().print(table)


if __name__ == "__main__":
    main()
