"""Collect garbage: delete creatures of deleted runs that nothing uses."""

from collections.abc import Collection

from sqlalchemy import delete, select, union
from sqlalchemy.orm import Session

from ..core.database import insert_missing
from ..storage.garbage import discard
from ..tables import (
    Artifact,
    Choice,
    Creature,
    Elite,
    GarbageCreature,
    InitialCreature,
    Parent,
    Result,
    Run,
    Share,
)

CREATURES_PER_TRANSACTION = 200


def in_use(session: Session, names: Collection[str]) -> set[str]:
    """Return those of the creatures that are in use. Each kind of use has a line here.

    A parent of a kept creature is in use, so that lineage stays complete.
    """
    uses = (
        select(Elite.creature).where(Elite.creature.in_(names)),
        select(Result.creature).where(Result.creature.in_(names)),
        select(InitialCreature.creature).where(InitialCreature.creature.in_(names)),
        select(Choice.creature).where(Choice.creature.in_(names)),
        select(Share.creature).where(Share.creature.in_(names)),
        select(Share.cover).where(Share.cover.in_(names)),
        select(Parent.parent).where(Parent.parent.in_(names)),
        select(Creature.sha256).where(Creature.sha256.in_(names), Creature.imported),
    )
    return {name for name in session.scalars(union(*uses)) if name is not None}


def collect(session: Session) -> bool:
    """Delete the next few that are not in use; return False if none are left to check."""
    exists = select(Run.id).where(Run.id == GarbageCreature.run_id).exists()
    rows = (
        select(GarbageCreature)
        .where(~exists)
        .order_by(GarbageCreature.creature)
        .limit(CREATURES_PER_TRANSACTION)
    )
    checked = {row.creature: row.run_id for row in session.scalars(rows)}
    if not checked:
        return False
    # Transactions that would use one wait for this lock, and then find it deleted.
    locked = select(Creature).where(Creature.sha256.in_(checked)).order_by(Creature.sha256)
    found = {row.sha256: row.parents for row in session.scalars(locked.with_for_update())}
    gone = sorted(found.keys() - in_use(session, found))
    session.execute(
        delete(GarbageCreature).where(
            GarbageCreature.creature.in_(checked), GarbageCreature.run_id.in_(checked.values())
        )
    )
    # Rows of their renderings go too; files are deleted later.
    files = delete(Artifact).where(Artifact.creature.in_(gone)).returning(Artifact.path)
    discard(session, list(session.scalars(files)))
    session.execute(delete(Parent).where(Parent.child.in_(gone)))
    session.execute(delete(Creature).where(Creature.sha256.in_(gone)))
    # A parent may have been kept for its child alone.
    parents = {(checked[name], parent) for name in gone for parent in found[name]}
    rows = [{"run_id": run_id, "creature": parent} for run_id, parent in sorted(parents)]
    insert_missing(session, GarbageCreature, rows)
    return True
