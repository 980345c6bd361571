"""Statistics of finished runs by their specs, compared as `microcosmos compare` does."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING, Any
from uuid import UUID

import numpy as np
from sqlalchemy import Row, select
from sqlalchemy.orm import Session

from ..core.errors import ProblemError, invalid_field
from ..forks.forking import SEARCHES
from ..runs.lifecycle import NOT_IN_BIN
from ..tables import CORRECTED, FINISHED, TERMINAL, Generation, Run, Sweep
from .schemas import Statistics

if TYPE_CHECKING:
    from microcosmos.statistics import Comparison, RunRecord

COLUMNS = ("evaluations", "qd_score", "coverage", "best", "mean", "infeasible")
COMPARED = (Run.id, Run.experiment, Run.status, Run.generation, Run.rewinds, Run.sweep_index)
Found = Row[UUID, str, str, int, int, int | None]
MAX_MEASURES = 12
FORMS = {"csv": "text/csv", "tex": "application/x-tex"}
"""Media types of tables to download."""


@dataclass(frozen=True)
class Asked:
    """Which runs are compared by what; with it, everything that an answer says is fixed."""

    runs: tuple[UUID, ...]
    left_out: int
    """Runs that failed or were cancelled."""
    state: tuple[Any, ...]
    measures: tuple[str, ...]


def of_sweep(session: Session, sweep_id: UUID, measures: str) -> Asked:
    """Return what is asked of all runs of a sweep, in the order of its cases.

    Raise `ProblemError` where it cannot be compared.
    """
    sweep = session.get(Sweep, sweep_id)
    if sweep is None:
        raise ProblemError(404, "Not found", f"No sweep has the id {sweep_id}.")
    cases = prod(map(len, sweep.grid.values()))
    mine = select(*COMPARED).where(Run.sweep == sweep_id, NOT_IN_BIN).order_by(Run.sweep_index)
    runs = session.execute(mine).all()
    return _asked(sorted(runs, key=lambda run: run.sweep_index % cases), measures)


def of_runs(session: Session, ids: Sequence[UUID], measures: str) -> Asked:
    """Return what is asked of some runs, in their order.

    Raise `ProblemError` where they cannot be compared.
    """
    found = session.execute(select(*COMPARED).where(Run.id.in_(ids), NOT_IN_BIN))
    runs = {run.id: run for run in found}
    for missing in (one for one in ids if one not in runs):
        raise ProblemError(404, "Not found", f"No run has the id {missing}.")
    return _asked([runs[one] for one in dict.fromkeys(ids)], measures)


def _asked(runs: Sequence[Found], measures: str) -> Asked:
    for table in (run.experiment for run in runs if run.experiment not in SEARCHES):
        detail = f"Statistics need archives; runs of `{table}` have tables."
        raise ProblemError(404, "No statistics", detail)
    finished = [run for run in runs if run.status == FINISHED]
    active = sum(run.status not in TERMINAL for run in runs)
    if active or not finished:
        detail = f"Statistics need finished runs; {len(finished)} of {len(runs)} are finished."
        raise ProblemError(409, "Runs are not finished", detail)
    named = tuple(one.strip() for one in measures.split(",") if one.strip())
    if len(named) > MAX_MEASURES:
        raise invalid_field("measures", f"at most {MAX_MEASURES} measures", len(named))
    state = tuple((run.id, run.generation, run.rewinds) for run in finished)
    ids = tuple(run.id for run in finished)
    return Asked(ids, len(runs) - len(finished), state, named)


def compared(session: Session, wanted: Asked) -> "Comparison":
    """Compare the cases. Raise `ProblemError` where they cannot be compared."""
    from microcosmos.statistics import by_spec, compare  # Loads SciPy.
    from microcosmos.statistics.measures import DEFAULT, Measure

    try:
        measures = [Measure.parse(text) for text in wanted.measures or DEFAULT]
    except ValueError as error:
        raise invalid_field("measures", f"{error}", ", ".join(wanted.measures)) from error
    last = all(one.at is None and one.reaches is None for one in measures)
    try:
        return compare(by_spec(records(session, wanted.runs, last)), measures)
    except ValueError as error:
        raise ProblemError(409, "Cannot be compared", f"{error}.") from error


def document(session: Session, wanted: Asked) -> Statistics:
    """Return the comparison for the page."""
    from microcosmos.statistics import tables

    found = tables.document(compared(session, wanted))
    told = {name: found[name] for name in Statistics.model_fields}
    if wanted.left_out:
        runs = "1 run is" if wanted.left_out == 1 else f"{wanted.left_out} runs are"
        caution = f"{runs} left out, since they failed or were cancelled."
        told["cautions"] = [caution, *told["cautions"]]
    return Statistics.model_validate(told)


def table(session: Session, wanted: Asked, form: str) -> str:
    """Return the comparison as CSV or LaTeX."""
    from microcosmos.statistics import tables

    return {"csv": tables.csv, "tex": tables.latex}[form](compared(session, wanted))


def records(session: Session, runs: Sequence[UUID], last: bool) -> list["RunRecord"]:
    """Return runs with their curves, or with the `last` generation of each alone."""
    from microcosmos.statistics import RunRecord

    names = (Run.id, Run.spec, Run.version, Run.device)
    rows = session.execute(select(*names).where(Run.id.in_(runs)))
    found = {row.id: row for row in rows}
    curves = _curves(session, runs, last)
    return [
        RunRecord(
            name=str(run.id),
            document=run.spec,
            curves=curves[run.id],
            version=run.version,
            devices=(run.device or "an unknown device",),
            state="finished",
        )
        for run in (found[run_id] for run_id in runs if run_id in found)
        if run.id in curves
    ]


def _curves(
    session: Session, runs: Sequence[UUID], last: bool
) -> dict[UUID, dict[str, np.ndarray]]:
    columns = [getattr(Generation, name) for name in COLUMNS]
    wanted = (
        select(Generation.run_id, *columns, Generation.summary)
        .join(Run, Run.id == Generation.run_id)
        .where(Run.id.in_(runs), Generation.generation <= Run.generation)
        .order_by(Generation.run_id, Generation.generation)
    )
    if last:
        wanted = wanted.where(Generation.generation == Run.generation)
    rows: dict[UUID, list[list[float | None]]] = {}
    for run_id, *values, summary in session.execute(wanted):
        corrected = [(summary or {}).get(name) for name in CORRECTED]
        rows.setdefault(run_id, []).append([*values, *corrected])
    return {
        run_id: dict(zip((*COLUMNS, *CORRECTED), np.array(each, float).T, strict=True))
        for run_id, each in rows.items()
    }
