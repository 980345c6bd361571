"""Insert creatures and the links to their parents; mark those that may be garbage."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, cast
from uuid import UUID

from sqlalchemy import Select, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from ..core.database import insert_missing, insert_or_update
from ..tables import Creature, Elite, GarbageCreature, Parent, Result

NAMES_PER_QUERY = 500


def creature_columns(
    sha256: str,
    identity: bytes,
    measured: Mapping[str, Any] | None,
    provenance: Mapping[str, Any] | None,
    licence: str,
    credit: Sequence[str] = (),
) -> dict[str, Any]:
    """Return the row of a creature. Lineage has columns of its own."""
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


def insert_and_lock(session: Session, rows: Sequence[dict[str, Any]]) -> None:
    """Insert creatures. Existing ones cannot be deleted before the transaction ends."""
    if rows:
        # This update changes nothing; it takes the lock of the row.
        same = {"licence": Creature.__table__.c.licence}
        insert_or_update(session, Creature, rows, ["sha256"], same)


def link(session: Session, names: Sequence[str]) -> None:
    """Insert the links of existing creatures to their parents, as their rows name them."""
    for first in range(0, len(names), NAMES_PER_QUERY):
        mine = Creature.sha256.in_(names[first : first + NAMES_PER_QUERY])
        found = session.execute(select(Creature.sha256, Creature.parents).where(mine))
        insert_missing(session, Parent, [row for one in found for row in links(*one)])


def links(child: str, parents: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Yield a row for each parent of a creature."""
    for position, parent in enumerate(parents):
        yield {"child": child, "position": position, "parent": parent}


def named(run_id: UUID, table: type[Elite | Result], after: int = 0) -> Select[str]:
    """Select the creatures of a run's rows after a generation."""
    mine = (table.run_id == run_id) & (table.generation > after)
    return creatures_of(table).where(mine)


def creatures_of(table: type[Elite | Result]) -> Select[str]:
    """Select the distinct creatures of rows."""
    creature = cast(InstrumentedAttribute[str], table.creature)
    return select(creature).where(creature.is_not(None)).distinct()


def mark_garbage(session: Session, run_id: UUID, *creatures: Select[str]) -> None:
    """Mark creatures for collection once their run is deleted, unless something uses them."""
    names = sorted({name for some in creatures for name in session.scalars(some)})
    rows = [{"run_id": run_id, "creature": name} for name in names]
    insert_missing(session, GarbageCreature, rows)
