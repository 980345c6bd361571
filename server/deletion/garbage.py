"""Creatures of runs that are gone: which anything still uses, and the end of the others."""

from collections.abc import Collection, Sequence

from sqlalchemy import delete, select, union
from sqlalchemy.orm import Session

from ..core.database import insert_missing
from ..tables import (
    Artifact,
    Creature,
    Elite,
    GarbageCreature,
    GarbageFile,
    InitialCreature,
    Parent,
    Result,
    Run,
    Share,
)

AT_ONCE = 200
"""Creatures that are judged in one transaction."""


def in_use(session: Session, names: Collection[str]) -> set[str]:
    """Which of these creatures anything uses: whoever keeps a creature has a line here.

    Who has a child that stays, stays too, so that lineage has no holes.
    """
    uses = (
        select(Elite.creature).where(Elite.creature.in_(names)),
        select(Result.creature).where(Result.creature.in_(names)),
        select(InitialCreature.creature).where(InitialCreature.creature.in_(names)),
        select(Share.creature).where(Share.creature.in_(names)),
        select(Share.cover).where(Share.cover.in_(names)),
        select(Parent.parent).where(Parent.parent.in_(names)),
        select(Creature.sha256).where(Creature.sha256.in_(names), Creature.imported),
    )
    return {name for name in session.scalars(union(*uses)) if name is not None}


def collect(session: Session) -> bool:
    """Delete the next few that nothing uses; whether there were any to judge."""
    there = select(Run.id).where(Run.id == GarbageCreature.run_id).exists()
    rows = (
        select(GarbageCreature).where(~there).order_by(GarbageCreature.creature).limit(AT_ONCE)
    )
    judged = {row.creature: row.run_id for row in session.scalars(rows)}
    if not judged:
        return False
    # Whoever wants to use one from here on waits, and then finds that it is gone.
    locked = select(Creature).where(Creature.sha256.in_(judged)).order_by(Creature.sha256)
    found = {row.sha256: row.parents for row in session.scalars(locked.with_for_update())}
    gone = sorted(found.keys() - in_use(session, found))
    session.execute(
        delete(GarbageCreature).where(
            GarbageCreature.creature.in_(judged), GarbageCreature.run_id.in_(judged.values())
        )
    )
    _delete(session, gone)
    # A parent may have stayed for the sake of its child alone.
    parents = {(judged[name], parent) for name in gone for parent in found[name]}
    rows = [{"run_id": run_id, "creature": parent} for run_id, parent in sorted(parents)]
    insert_missing(session, GarbageCreature, rows)
    return True


def _delete(session: Session, names: Sequence[str]) -> None:
    """Creatures and their renderings; files go later, when nothing names them any more."""
    files = delete(Artifact).where(Artifact.creature.in_(names)).returning(Artifact.path)
    discard(session, list(session.scalars(files)))
    session.execute(delete(Parent).where(Parent.child.in_(names)))
    session.execute(delete(Creature).where(Creature.sha256.in_(names)))


def discard(session: Session, paths: Sequence[str]) -> None:
    """Have files removed, once this transaction has happened."""
    insert_missing(session, GarbageFile, [{"path": path} for path in paths])
