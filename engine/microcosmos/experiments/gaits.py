"""Hand-made gaits at every viscosity: the Microcosmos paper's sweep, in several forms."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from .. import naming, search, units
from ..archive.report import Report, Row
from . import table_file
from .table_file import Table


@dataclass(frozen=True)
class Stroke:
    """One swimmer in one form of the coupling: what a generation computes."""

    form: str
    swimmer: str
    force_free: bool
    program: Callable[[search.Conditions], search.Evaluation]
    conditions: search.Conditions
    """Of all points, as NumPy arrays."""
    viscosities: tuple[float, ...]
    sperm: tuple[float, ...]
    """Effective sperm number of each point."""
    spacing: float
    """The widest distance between nodes, in cells."""
    identities: tuple[Mapping[str, Any], ...]
    """What the creature of each point is."""


@dataclass(frozen=True)
class Gaits:
    """A sweep, driven by whoever holds it: a generation is one stroke at all viscosities."""

    spec: str
    """The whole spec as JSON."""
    strokes: tuple[Stroke, ...]
    block: int
    device: str

    def init(self) -> Table:
        """Before the first generation."""
        return Table(0, (), (self.device,))

    def done(self, state: Table) -> bool:
        """Whether all strokes are swum."""
        return state.generation >= len(self.strokes)

    def generation(self, state: Table) -> int:
        """Strokes that are swum."""
        return state.generation

    def advance(
        self, state: Table, stop: Callable[[], bool] = search.never
    ) -> tuple[Table, Report]:
        """One stroke at all viscosities, by blocks.

        Raises `Stopped` where `stop()` says so between blocks; `state` stays as it was.
        """
        stroke = self.strokes[state.generation]
        found = search.evaluate_blocks(
            stroke.program, stroke.conditions, block=self.block, stop=stop
        )
        rows = tuple(self._row(stroke, point, found) for point in range(len(found.fitness)))
        state = state.grown(rows)
        return state, _report(state, rows)

    def save(self, state: Table) -> bytes:
        """The table's file, from which the run can also be taken up again."""
        return table_file.save(self.spec, state)

    def restore(self, data: bytes, *, other_device: bool = False) -> Table:
        """The state in a file of the same spec; raises `ValueError` or `OtherDevice`."""
        return table_file.restore(self.spec, self.device, data, other_device=other_device)

    def best(self, state: Table) -> None:
        """There is none: points do not compete."""

    def _row(self, stroke: Stroke, point: int, found: search.Evaluation) -> Row:
        names, values = search.STROKE_MEASURES, found.measures[point].tolist()
        measures: dict[str, float] = dict(zip(names, values, strict=True))
        status = search.STATUSES[int(found.status[point])]
        ok = status != "non-finite"
        said = units.warnings(
            mach=measures["mach"], limited=measures["limited"], spacing=stroke.spacing
        )
        row = {
            "form": stroke.form,
            "swimmer": stroke.swimmer,
            "viscosity": stroke.viscosities[point],
            "displacement": measures["cycle"] if ok else None,
            "direction": measures["direction"] if ok else None,
            "reynolds": measures["reynolds"] if ok else None,
            "sperm": stroke.sperm[point],
            "mach": measures["mach"] if ok else None,
            "limited": measures["limited"] if ok else None,
            "impulse": measures["impulse"] if ok else None,
            "status": status,
            "force_free": stroke.force_free,
            "warnings": "; ".join(said) if ok else "the simulation did not stay finite",
        }
        if not ok:
            return Row(row)
        identity = stroke.identities[point]
        measured = {
            "fitness": measures["displacement"],
            "descriptors": {},
            "measures": measures,
            "block": self.block,
            "room": None,
            "device": self.device,
        }
        name, canonical = naming.name(identity), naming.canonical(identity)
        return Row(row, name, canonical, measured, naming.provenance("hand-made"))


def stack(points: list[search.Conditions]) -> search.Conditions:
    """Conditions of many points as NumPy arrays, the point first."""
    return jax.tree.map(lambda *values: np.stack([np.asarray(v) for v in values]), *points)


def _report(state: Table, rows: tuple[Row, ...]) -> Report:
    failed = sum(row.values["status"] != "ok" for row in state.rows)
    warned = sum(bool(row.values["warnings"]) for row in state.rows)
    return Report(
        generation=state.generation,
        evaluations=len(state.rows),
        diverged=failed,
        rows=rows,
        summary={"points": len(state.rows), "failed": failed, "warned": warned},
    )
