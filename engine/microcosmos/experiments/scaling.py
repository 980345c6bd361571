"""Wall time against the number of nodes: the Microcosmos paper's figure, part by part."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import search
from ..archive.report import Report, Row, Value
from . import table_file
from .table_file import Table

LINEAR_FROM = 16_000
"""Nodes from which the exponent is fitted: below, fixed costs of a call count."""

FEWEST = 3
"""Points of a fit; where fewer are that large, the largest ones."""


@dataclass(frozen=True)
class Scaling:
    """A measurement, driven by whoever holds it: a generation is one number of nodes.

    Times are a machine's: they are the one result here that no second run repeats.
    """

    spec: str
    nodes: tuple[int, ...]
    measure: Callable[[int, Callable[[], bool]], tuple[Mapping[str, Value], ...]]
    """The rows of a number of nodes; asks whether to stop between its programs."""
    device: str

    def init(self) -> Table:
        """Before the first generation."""
        return Table(0, (), (self.device,))

    def done(self, state: Table) -> bool:
        """Whether all numbers are measured."""
        return state.generation >= len(self.nodes)

    def generation(self, state: Table) -> int:
        """Numbers of nodes that are measured."""
        return state.generation

    def advance(
        self, state: Table, stop: Callable[[], bool] = search.never
    ) -> tuple[Table, Report]:
        """One number of nodes; raises `Stopped` where `stop()` says so."""
        rows = tuple(Row(row) for row in self.measure(self.nodes[state.generation], stop))
        state = state.grown(rows)
        return state, Report(
            generation=state.generation,
            evaluations=state.generation,
            diverged=sum(row.values["status"] != "ok" for row in state.rows),
            rows=rows,
            summary=summary([row.values for row in state.rows]),
        )

    def save(self, state: Table) -> bytes:
        """The table's file, from which the run can also be taken up again."""
        return table_file.save(self.spec, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> Table:
        """The state in a file of the same spec; raises `ValueError` or `OtherDevice`."""
        return table_file.restore(self.spec, self.device, data, other_device=other_device)

    def best(self, state: Table) -> None:
        """There is none."""


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Value]:
    """Exponents of the time that depends on nodes, and the most memory.

    The part that depends on nodes is all but the fluid, whose cells do not change. What did
    not stay finite does not count.
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
