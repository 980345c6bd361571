"""Insert creatures and the links to their parents."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from ..core.database import insert_missing, insert_or_update
from ..tables import Creature, Parent

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
