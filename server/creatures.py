"""Creatures between the database and the files that people share."""

import json
from typing import Any

from microcosmos.archive import creature
from sqlalchemy.orm import Session

from .models import Creature
from .records import insert_missing

WHERE_FROM = ("parents", "operator")


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
    if session.get(Creature, file["sha256"]):
        return False
    provenance = file["provenance"]
    row = {
        "sha256": file["sha256"],
        "identity": creature.canonical(file["identity"]),
        "parents": list(provenance["parents"]) if provenance else [],
        "operator": provenance["operator"] if provenance else None,
        "measured": file["measured"],
        "provenance": provenance
        and {key: value for key, value in provenance.items() if key not in WHERE_FROM},
        "licence": file["licence"],
    }
    insert_missing(session, Creature, [row])
    return True
