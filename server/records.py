"""What an experiment reports, as rows and as events."""

from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any, Protocol
from uuid import UUID

from sqlalchemy import insert
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from microcosmos.archive.creature import LICENCE

from .events import finite
from .models import Base, Creature, Elite, Generation


class NewElite(Protocol):
    """The engine's `Elite`, which the server does not import."""

    @property
    def cell(self) -> int: ...
    @property
    def fitness(self) -> float: ...
    @property
    def descriptors(self) -> Sequence[float]: ...
    @property
    def creature(self) -> str: ...
    @property
    def identity(self) -> bytes: ...
    @property
    def generation(self) -> int: ...
    @property
    def measured(self) -> Mapping[str, Any]: ...
    @property
    def provenance(self) -> Mapping[str, Any]: ...


class Report(Protocol):
    """The engine's `Report`: a generation as it stands, and the cells that it changed."""

    @property
    def generation(self) -> int: ...
    @property
    def qd_score(self) -> float: ...
    @property
    def coverage(self) -> float: ...
    @property
    def best(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def evaluations(self) -> int: ...
    @property
    def diverged(self) -> int: ...
    @property
    def elites(self) -> Sequence[NewElite]: ...


def standing(report: Report) -> dict[str, Any]:
    """What the row of a run says about its last generation."""
    return {
        "generation": int(report.generation),
        "qd_score": finite(report.qd_score),
        "coverage": finite(report.coverage),
        "best": finite(report.best),
        "evaluations": int(report.evaluations),
        "diverged": int(report.diverged),
    }


def generation_row(report: Report, seconds: float) -> dict[str, Any]:
    return {**standing(report), "mean": finite(report.mean), "seconds": seconds}


def elite_row(elite: NewElite) -> dict[str, Any]:
    return {
        "cell": int(elite.cell),
        "generation": int(elite.generation),
        "fitness": float(elite.fitness),
        "descriptor_0": float(elite.descriptors[0]),
        "descriptor_1": float(elite.descriptors[1]),
        "creature": elite.creature,
    }


def creature_row(elite: NewElite) -> dict[str, Any]:
    return creature_columns(
        elite.creature, elite.identity, elite.measured, elite.provenance, LICENCE
    )


def creature_columns(
    sha256: str,
    identity: bytes,
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
    licence: str,
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
    }


def insert_missing(session: Session, table: type[Base], rows: Sequence[dict[str, Any]]) -> None:
    """Insert rows, leaving those alone whose key is there already."""
    postgres = session.get_bind().dialect.name == "postgresql"
    dialect = postgresql if postgres else sqlite
    if rows:
        session.execute(dialect.insert(table).on_conflict_do_nothing(), rows)


def write(
    session: Session,
    run_id: UUID,
    curve: dict[str, Any],
    elites: list[dict[str, Any]],
    creatures: list[dict[str, Any]],
) -> None:
    session.execute(insert(Generation), [{"run_id": run_id, **curve}])
    # In one order, so that two runs with the same creatures cannot wait for each other.
    insert_missing(session, Creature, sorted(creatures, key=itemgetter("sha256")))
    if elites:
        session.execute(insert(Elite), [{"run_id": run_id, **row} for row in elites])


def elites_event(run_id: UUID, generation: int, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Changed cells, as columns."""
    return {
        "run": str(run_id),
        "generation": generation,
        "cell": [row["cell"] for row in rows],
        "fitness": [row["fitness"] for row in rows],
        "descriptors": [[row["descriptor_0"], row["descriptor_1"]] for row in rows],
        "elite_generation": [row["generation"] for row in rows],
        "creature": [row["creature"] for row in rows],
    }
