"""What an experiment reports, as rows and as events."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any
from uuid import UUID

from sqlalchemy import func, insert, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from microcosmos.archive.creature import LICENCE

from ..events.stream import finite
from ..tables import Base, Creature, Elite, Generation, Parent, Result
from .report import NewElite, NewRow, Report

AT_ONCE = 500
"""Names in one question to the database."""


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


def elite_row(elite: NewElite) -> dict[str, Any]:
    return {
        "cell": int(elite.cell),
        "generation": int(elite.generation),
        "fitness": float(elite.fitness),
        "descriptors": [float(value) for value in elite.descriptors],
        "creature": elite.creature,
    }


def result_row(generation: int, row: NewRow) -> dict[str, Any]:
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


def creature_columns(
    sha256: str,
    identity: bytes,
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
    licence: str,
    credit: Sequence[str] = (),
) -> dict[str, Any]:
    """A creature's row; lineage has columns of its own."""
    origin = dict(provenance) if provenance else {}
    return {
        "sha256": sha256,
        "identity": identity,
        "parents": list(origin.pop("parents", ())),
        "operator": origin.pop("operator", None),
        "measured": dict(measured) if measured else None,
        "provenance": origin or None,
        "licence": licence,
        "credit": list(credit),
    }


def insert_missing(session: Session, table: type[Base], rows: Sequence[dict[str, Any]]) -> None:
    """Insert rows, leaving those alone whose key is there already."""
    if rows:
        session.execute(_insert(session, table).on_conflict_do_nothing(), rows)


def hold(session: Session, rows: Sequence[dict[str, Any]]) -> None:
    """Insert creatures; those that are there already cannot go before the transaction ends."""
    if rows:
        # A change that changes nothing, for the sake of its lock.
        same = {"licence": Creature.__table__.c.licence}
        keyed = _insert(session, Creature).on_conflict_do_update(
            index_elements=["sha256"], set_=same
        )
        session.execute(keyed, rows)


def _insert(session: Session, table: type[Base]) -> Any:
    postgres = session.get_bind().dialect.name == "postgresql"
    return (postgresql if postgres else sqlite).insert(table)


def link(session: Session, names: Sequence[str]) -> None:
    """Keep the links of creatures that are there to their parents, as their rows have them."""
    for first in range(0, len(names), AT_ONCE):
        mine = Creature.sha256.in_(names[first : first + AT_ONCE])
        found = session.execute(select(Creature.sha256, Creature.parents).where(mine))
        insert_missing(session, Parent, [row for one in found for row in links(*one)])


def links(child: str, parents: Sequence[str]) -> Iterator[dict[str, Any]]:
    """A row for each parent of a creature."""
    for position, parent in enumerate(parents):
        yield {"child": child, "position": position, "parent": parent}


def write(session: Session, run_id: UUID, rows: Rows) -> None:
    session.execute(
        insert(Generation), [{"run_id": run_id, **rows.curve, "summary": rows.summary}]
    )
    # In one order, so that two runs with the same creatures cannot wait for each other.
    found = sorted(rows.creatures, key=itemgetter("sha256"))
    hold(session, found)
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
