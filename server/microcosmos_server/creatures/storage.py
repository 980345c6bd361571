"""Creatures in the database: insert, link to parents, mark as garbage, write as files."""

import json
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import Any, cast
from uuid import UUID

from sqlalchemy import Select, Text, case, func, literal_column, or_, select, update
from sqlalchemy import cast as sql_cast
from sqlalchemy.orm import InstrumentedAttribute, Session

from microcosmos.archive import creature, pedigree

from ..core.database import insert_missing, insert_or_update
from ..tables import Creature, Elite, GarbageCreature, Parent, Result
from . import lineage

NAMES_PER_QUERY = 500
MAX_DEPTH = 32
"""Generations of ancestors in a creature file."""
ANCESTRY_BYTES = 3 << 20
"""Limit on their identities, so that a server accepts the file as an import."""


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
    """Insert creatures. Existing ones cannot be deleted before the transaction ends.

    An existing creature without a pose stream gets the new one. What somebody's file says that
    it measured gives way to the first evaluation here: the name is a hash of the identity
    alone.
    """
    if rows:
        # The update takes the lock of the row, also if it changes nothing.
        columns = Creature.__table__.c
        poses, measured = (literal_column(f"excluded.{name}") for name in ("poses", "measured"))
        # `excluded`, since SQLAlchemy would add the table itself to the subquery.
        name = literal_column("excluded.sha256")
        found = [
            select(table.creature).where(table.creature == name).exists()
            for table in (Elite, Result)
        ]
        given = func.coalesce(sql_cast(measured, Text), "null") != "null"
        values = {
            "poses": func.coalesce(columns.poses, poses),
            "measured": case((or_(*found) | ~given, columns.measured), else_=measured),
        }
        insert_or_update(session, Creature, rows, ["sha256"], values)


def link(session: Session, names: Sequence[str]) -> None:
    """Insert the links of existing creatures to their parents, as their rows name them."""
    # A report may have thousands of creatures, and databases limit the parameters of a
    # statement.
    for first in range(0, len(names), NAMES_PER_QUERY):
        some = Creature.sha256.in_(names[first : first + NAMES_PER_QUERY])
        rows = [
            {"child": child, "position": position, "parent": parent}
            for child, parents in session.execute(
                select(Creature.sha256, Creature.parents).where(some)
            )
            for position, parent in enumerate(parents)
        ]
        insert_missing(session, Parent, rows)


def creatures_of(table: type[Elite | Result]) -> Select[str]:
    column = cast(InstrumentedAttribute[str], table.creature)
    return select(column).where(column.is_not(None)).distinct()


def mark_garbage(session: Session, run_id: UUID, *creatures: Select[str]) -> None:
    """Mark creatures for collection once their run is deleted, unless something uses them."""
    names = sorted({name for some in creatures for name in session.scalars(some)})
    rows = [{"run_id": run_id, "creature": name} for name in names]
    insert_missing(session, GarbageCreature, rows)


def document(row: Creature) -> dict[str, Any]:
    """Return the creature file."""
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
    """Return the creature file with the files of its ancestors, nearest first."""
    found = lineage.ancestors(session, row, MAX_DEPTH).items
    names = [relative.creature for relative in found if relative.stored]
    rows = session.scalars(select(Creature).where(Creature.sha256.in_(names)))
    by_name = {row.sha256: row for row in rows}
    ancestors, room = [], ANCESTRY_BYTES
    for name in names:
        room -= len(by_name[name].identity)
        if room < 0:
            break
        ancestors.append(document(by_name[name]))
    return pedigree.document(document(row), ancestors)


def import_files(session: Session, *files: dict[str, Any]) -> None:
    """Import checked creature files, sorted, so that two requests cannot deadlock.

    A known creature stays as it is, with what was measured here.
    """
    for file in sorted(files, key=itemgetter("sha256")):
        name = file["sha256"]
        known = update(Creature).where(Creature.sha256 == name).values(imported=True)
        if session.scalars(known.returning(Creature.sha256)).one_or_none():
            continue
        identity = creature.canonical(file["identity"])
        columns = [file[key] for key in ("measured", "provenance", "licence", "credit")]
        row = creature_columns(name, identity, *columns)
        # A run may be inserting it at this moment.
        given = {**row, "imported": True}
        insert_or_update(session, Creature, [given], ["sha256"], {"imported": True})
        link(session, [name])
