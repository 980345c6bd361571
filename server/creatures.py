"""Creatures between the database and the files that people share."""

import json
from typing import Any

from sqlalchemy import update
from sqlalchemy.orm import Session

from microcosmos.archive import creature

from .models import Creature
from .records import creature_columns, insert_missing, link


def document(row: Creature) -> dict[str, Any]:
    """The creature file."""
    provenance = row.provenance and {
        "parents": row.parents,
        "operator": row.operator,
        **row.provenance,
    }
    return {
        "identity": json.loads(row.identity),
        "sha256": row.sha256,
        "measured": row.measured,
        "provenance": provenance,
        "licence": row.licence,
    }


def add(session: Session, file: dict[str, Any]) -> bool:
    """Keep a creature file that was checked: whether it is new. What is known stays."""
    mine = update(Creature).where(Creature.sha256 == file["sha256"]).values(imported=True)
    if session.scalars(mine.returning(Creature.sha256)).one_or_none():
        return False
    row = creature_columns(
        file["sha256"],
        creature.canonical(file["identity"]),
        file["measured"],
        file["provenance"],
        file["licence"],
    )
    insert_missing(session, Creature, [{**row, "imported": True}])
    link(session, [file["sha256"]])
    return True
