"""Creatures between the database and the files that people share."""

import json
from collections.abc import Sequence
from operator import itemgetter
from typing import Any

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from microcosmos.archive import creature, pedigree

from ..core.database import insert_missing
from ..tables import Creature
from . import lineage
from .insertion import creature_columns, link

FARTHEST = 32
"""Generations of ancestors that travel with a creature."""
ANCESTRY_BYTES = 3 << 20
"""Of their identities: a document can be sent where it is to be imported."""


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
        "credit": row.credit,
    }


def with_ancestors(session: Session, row: Creature) -> dict[str, Any]:
    """The creature file with those of its ancestors that are kept, the nearest first."""
    found = lineage.ancestors(session, row, FARTHEST).items
    names = [relative.creature for relative in found if relative.kept]
    rows = session.scalars(select(Creature).where(Creature.sha256.in_(names)))
    by_name = {row.sha256: row for row in rows}
    taken, room = [], ANCESTRY_BYTES
    for name in names:
        room -= len(by_name[name].identity)
        if room < 0:
            break
        taken.append(document(by_name[name]))
    return pedigree.document(document(row), taken)


def add_all(session: Session, files: Sequence[dict[str, Any]]) -> None:
    """Keep several: in one order, so that two such requests cannot wait for each other."""
    for file in sorted(files, key=itemgetter("sha256")):
        add(session, file)


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
        file["credit"],
    )
    insert_missing(session, Creature, [{**row, "imported": True}])
    link(session, [file["sha256"]])
    return True
