"""Wall time against the number of nodes: the Microcosmos paper's figure, part by part."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..archive.report import Report, Row, Value
from .table_file import Table

LINEAR_FROM = 16_000
"""Nodes from which the exponent is fitted: below, fixed costs of a call count."""

FEWEST = 3
"""Least number of points of a fit; smaller ones are added if needed."""


def report(state: Table, rows: tuple[Row, ...]) -> Report:
    """The exponents so far. Times are a machine's: no second run repeats them."""
    return Report(
        generation=state.generation,
        evaluations=state.generation,
        diverged=sum(row.values["status"] != "ok" for row in state.rows),
        rows=rows,
        summary=summary([row.values for row in state.rows]),
    )


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Value]:
    """Exponents of the time that depends on nodes, and the most memory.

    The part that depends on nodes is all but the fluid, whose cells do not change. Rows that
    did not stay finite are left out.
    """
    sound = [row for row in rows if row["status"] == "ok"]
    ours = [row for row in sound if row["method"] == "microcosmos"]
    pairs = [row for row in sound if row["method"] == "all-pairs"]
    memory = [row["memory_bytes"] for row in ours if row["memory_bytes"] is not None]
    counts = sorted(row["nodes"] for row in ours)
    start = min(LINEAR_FROM, counts[-FEWEST]) if len(counts) >= FEWEST else LINEAR_FROM
    large = [(r["nodes"], r["seconds"] - r["fluid"]) for r in ours if r["nodes"] >= start]
    return {
        "exponent": _exponent(large),
        "exponent_from": start,
        "exponent_all_pairs": _exponent([(r["nodes"], r["seconds"]) for r in pairs[-FEWEST:]]),
        "peak_memory_bytes": max(memory, default=None),
    }


def _exponent(points: list[tuple[float, float]]) -> float | None:
    """The slope of the line through the logarithms; None where there are too few points."""
    points = [(n, t) for n, t in points if t > 0]
    if len(points) < 2:
        return None
    nodes, seconds = np.log(np.array(points)).T
    return float(np.polyfit(nodes, seconds, 1)[0])
