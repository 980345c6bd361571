"""What an experiment reports, as rows and as events."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any
from uuid import UUID

from sqlalchemy import func, insert, select
from sqlalchemy.orm import Session

from microcosmos.archive import report
from microcosmos.archive.creature import LICENCE
from microcosmos.archive.report import Report

from ..creatures.storage import creature_columns, insert_and_lock, link
from ..services.event_stream import finite
from ..tables import Elite, Generation, Result


@dataclass(frozen=True)
class Rows:
    """A report, as the rows that are written of it."""

    curve: dict[str, Any]
    elites: list[dict[str, Any]]
    results: list[dict[str, Any]]
    """Without their place, which only the table knows."""
    creatures: list[dict[str, Any]]
    summary: dict[str, Any] | None


def rows_of(report: Report, seconds: float) -> Rows:
    """What is written of a generation at which the run has taken so many seconds."""
    named = [row for row in report.rows if row.creature is not None]
    return Rows(
        curve=generation_row(report, seconds),
        elites=[elite_row(elite) for elite in report.elites],
        results=[result_row(report.generation, row) for row in report.rows],
        creatures=[creature_row(one) for one in (*report.elites, *named)],
        summary=plain(report.summary),
    )


def standing(report: Report) -> dict[str, Any]:
    """What the row of a run says about its last generation."""
    summary = plain(report.summary)
    return {
        **({} if summary is None else {"summary": summary}),
        **figures(report),
    }


def figures(report: Report) -> dict[str, Any]:
    return {
        "generation": int(report.generation),
        "qd_score": finite(report.qd_score),
        "coverage": finite(report.coverage),
        "best": finite(report.best),
        "evaluations": int(report.evaluations),
        "diverged": int(report.diverged),
    }


def generation_row(report: Report, seconds: float) -> dict[str, Any]:
    return {**figures(report), "mean": finite(report.mean), "seconds": seconds}


def elite_row(elite: report.Elite) -> dict[str, Any]:
    return {
        "cell": int(elite.cell),
        "generation": int(elite.generation),
        "fitness": float(elite.fitness),
        "descriptors": [float(value) for value in elite.descriptors],
        "creature": elite.creature,
    }


def result_row(generation: int, row: report.Row) -> dict[str, Any]:
    return {
        "generation": int(generation),
        "values": plain(row.values),
        "creature": row.creature,
    }


def plain(values: Mapping[str, Any] | None) -> dict[str, Any] | None:
    """Flat values as JSON has them: what is not finite is None."""
    if values is None:
        return None
    return {
        name: finite(value) if isinstance(value, float) else value
        for name, value in values.items()
    }


def creature_row(found: Any) -> dict[str, Any]:
    """The creature of an elite, or of a row that has one."""
    return creature_columns(
        found.creature, found.identity, found.measured, found.provenance, LICENCE
    )


def write(session: Session, run_id: UUID, rows: Rows) -> None:
    session.execute(
        insert(Generation), [{"run_id": run_id, **rows.curve, "summary": rows.summary}]
    )
    # In one order, so that two runs with the same creatures cannot wait for each other.
    found = sorted(rows.creatures, key=itemgetter("sha256"))
    insert_and_lock(session, found)
    link(session, [row["sha256"] for row in found])
    if rows.elites:
        session.execute(insert(Elite), [{"run_id": run_id, **row} for row in rows.elites])
    if rows.results:
        first = count_results(session, run_id)
        placed = [{"number": first + i, **row} for i, row in enumerate(rows.results)]
        session.execute(insert(Result), [{"run_id": run_id, **row} for row in placed])


def count_results(session: Session, run_id: UUID) -> int:
    mine = select(func.count()).select_from(Result).where(Result.run_id == run_id)
    return session.execute(mine).scalar_one()


def events(run_id: UUID, rows: Rows) -> Iterator[tuple[str, dict[str, Any]]]:
    """What everybody is told of a generation."""
    run, generation = str(run_id), rows.curve["generation"]
    yield "generation", {"run": run, **rows.curve, "summary": rows.summary}
    if rows.elites:
        yield "elites", elites_event(run_id, generation, rows.elites)
    if rows.results:
        table = [{**row["values"], "creature": row["creature"]} for row in rows.results]
        told = {"generation": generation, "summary": rows.summary, "rows": table}
        yield "results", {"run": run, **told}


def elites_event(run_id: UUID, generation: int, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Changed cells, as columns."""
    return {
        "run": str(run_id),
        "generation": generation,
        "cell": [row["cell"] for row in rows],
        "fitness": [row["fitness"] for row in rows],
        "descriptors": [row["descriptors"] for row in rows],
        "elite_generation": [row["generation"] for row in rows],
        "creature": [row["creature"] for row in rows],
    }
