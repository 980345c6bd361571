"""Record the report of a generation: rows of the database, and events."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any
from uuid import UUID

from sqlalchemy import func, insert, select
from sqlalchemy.orm import Session

from microcosmos.archive.report import Report
from microcosmos.naming import LICENCE

from ..creatures.storage import creature_columns, insert_and_lock, link
from ..tables import CORRECTED, Elite, Generation, Result

COLUMNS = ("cell", "generation", "fitness", "descriptors", "creature")
"""Columns of elites, but for the run."""


@dataclass(frozen=True)
class Rows:
    """The rows of a report, without the id of the run."""

    run: dict[str, Any]
    """Columns of the run itself."""
    curve: dict[str, Any]
    elites: list[dict[str, Any]]
    emptied: list[int]
    """Cells that lost their elite and have no new one."""
    results: list[dict[str, Any]]
    """Without their number, which depends on the rows that the table holds."""
    creatures: list[dict[str, Any]]


def rows_of(report: Report, seconds: float) -> Rows:
    """Convert a report; `seconds` is the run's wall time so far."""
    elites = [(elite, elite.poses) for elite in report.elites]
    found = [*elites, *((row, None) for row in report.rows if row.creature is not None)]
    summary = json_values(report.summary)
    run = {
        "generation": int(report.generation),
        "qd_score": finite(report.qd_score),
        "coverage": finite(report.coverage),
        "best": finite(report.best),
        "evaluations": int(report.evaluations),
        "infeasible": int(report.infeasible),
        "seconds": seconds,
    }
    changed = {} if summary is None else {"summary": summary}
    known = summary or {}
    changed |= {name: known[name] for name in CORRECTED if name in known}
    return Rows(
        run=run | changed,
        curve={**run, "mean": finite(report.mean), "summary": summary},
        elites=[
            {
                "cell": int(elite.cell),
                "generation": int(elite.generation),
                "fitness": float(elite.fitness),
                "descriptors": [float(value) for value in elite.descriptors],
                "creature": elite.creature,
            }
            for elite in report.elites
        ],
        emptied=sorted(int(cell) for cell in report.emptied),
        results=[
            {
                "generation": run["generation"],
                "values": json_values(row.values),
                "creature": row.creature,
            }
            for row in report.rows
        ],
        creatures=[
            creature_columns(one.creature, one.identity, one.measured, one.provenance, LICENCE)
            | {"poses": poses}
            for one, poses in found
        ],
    )


def finite(value: float | None) -> float | None:
    """Return the value, or None where JSON and SQL cannot hold it (NaN, infinity)."""
    return value if value is not None and math.isfinite(value) else None


def json_values(values: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Replace numbers that are not finite by None, for JSON."""
    if values is None:
        return None
    return {
        name: finite(value) if isinstance(value, float) else value
        for name, value in values.items()
    }


def write(session: Session, run_id: UUID, rows: Rows) -> None:
    session.execute(insert(Generation), [{"run_id": run_id, **rows.curve}])
    # Sorted, so that two runs with the same creatures cannot deadlock.
    found = sorted(rows.creatures, key=itemgetter("sha256"))
    insert_and_lock(session, found)
    link(session, [row["sha256"] for row in found])
    if changed := [*rows.elites, *_losses(rows)]:
        session.execute(insert(Elite), [{"run_id": run_id, **row} for row in changed])
    if rows.results:
        first = count_results(session, run_id)
        placed = [
            {"run_id": run_id, "number": first + i, **row} for i, row in enumerate(rows.results)
        ]
        session.execute(insert(Result), placed)


def _losses(rows: Rows) -> list[dict[str, Any]]:
    """Return a row without a creature for each cell that lost its elite."""
    row = dict.fromkeys(COLUMNS) | {"generation": rows.curve["generation"]}
    return [{**row, "cell": cell} for cell in rows.emptied]


def count_results(session: Session, run_id: UUID) -> int:
    mine = select(func.count()).select_from(Result).where(Result.run_id == run_id)
    return session.execute(mine).scalar_one()


def events(run_id: UUID, rows: Rows) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield kind and data of the events of a generation."""
    head = {"run": str(run_id), "generation": rows.curve["generation"]}
    yield "generation", head | rows.curve
    if rows.elites or rows.emptied:
        columns = {name: [row[name] for row in rows.elites] for name in COLUMNS}
        columns |= {"elite_generation": columns["generation"], "emptied": rows.emptied}
        yield "elites", columns | head
    if rows.results:
        table = [{**row["values"], "creature": row["creature"]} for row in rows.results]
        yield "results", head | {"summary": rows.curve["summary"], "rows": table}
