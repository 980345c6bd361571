"""Hand-made gaits at every viscosity: the Microcosmos paper's sweep, in several forms."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import atan2, hypot
from typing import Any

import jax
import numpy as np

from .. import naming, search, units
from ..archive.report import Report, Row
from ..search.parts.records import measurement
from .table_file import Table


@dataclass(frozen=True)
class Stroke:
    """One swimmer in one form of the coupling at all viscosities: one generation."""

    form: str
    swimmer: str
    force_free: bool
    program: Callable[[search.Conditions], search.Evaluation]
    conditions: search.Conditions
    """Conditions of all points, as NumPy arrays."""
    viscosities: tuple[float, ...]
    sperm: tuple[float, ...]
    """Effective sperm number of each point."""
    spacing: float
    """The widest distance between nodes, in cells."""
    identities: tuple[Mapping[str, Any], ...]
    """Identity of the creature of each point."""


def stroke_rows(
    stroke: Stroke, stop: Callable[[], bool], *, block: int, device: str
) -> tuple[Row, ...]:
    """Return a row for each viscosity; raises `Stopped` between blocks if asked to."""
    results = search.evaluate_blocks(stroke.program, stroke.conditions, block=block, stop=stop)
    points = range(len(results.fitness))
    return tuple(_row(stroke, point, results, block, device) for point in points)


def _row(
    stroke: Stroke, point: int, results: search.Evaluation, block: int, device: str
) -> Row:
    names, values = search.STROKE_MEASURES, results.measures[point].tolist()
    measures: dict[str, float] = dict(zip(names, values, strict=True))
    cycle = measures["cycle_x"], measures["cycle_y"]
    status = search.STATUSES[int(results.status[point])]
    # A simulation that is not finite has no numbers; figures would draw them as results.
    ok = status != "non-finite"
    warnings = units.warnings(
        mach=measures["mach"], limited=measures["limited"], spacing=stroke.spacing
    )
    row = {
        "form": stroke.form,
        "swimmer": stroke.swimmer,
        "viscosity": stroke.viscosities[point],
        "displacement": hypot(*cycle) if ok else None,
        "direction": atan2(*reversed(cycle)) if ok else None,
        "reynolds": measures["reynolds"] if ok else None,
        "sperm": stroke.sperm[point],
        "mach": measures["mach"] if ok else None,
        "limited": measures["limited"] if ok else None,
        "impulse": measures["impulse"] if ok else None,
        "status": status,
        "force_free": stroke.force_free,
        "warnings": "; ".join(warnings) if ok else "the simulation did not stay finite",
    }
    if not ok:
        return Row(row)
    identity = stroke.identities[point]
    measured = measurement(measures["displacement"], measures, block=block, device=device)
    name, provenance = naming.name(identity), naming.provenance("hand-made")
    return Row(row, name, naming.canonical(identity), measured, provenance)


def stack(points: list[search.Conditions]) -> search.Conditions:
    """Stack the conditions of many points as NumPy arrays, the point first."""
    return jax.tree.map(lambda *values: np.stack([np.asarray(v) for v in values]), *points)


def report(state: Table, rows: tuple[Row, ...]) -> Report:
    """Return the number of points, and of those that failed or have warnings."""
    failed = sum(row.values["status"] != "ok" for row in state.rows)
    warned = sum(bool(row.values["warnings"]) for row in state.rows)
    return Report(
        generation=state.generation,
        evaluations=len(state.rows),
        infeasible=failed,
        rows=rows,
        summary={"points": len(state.rows), "failed": failed, "warned": warned},
    )
