"""Creatures that a run begins from: there, fit for its spec, and kept as long as the run is."""

from collections.abc import Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive.origin import genes_of
from microcosmos.spec import Evolution, Refinement, Spec

from .creatures import document
from .models import Creature, Origin, Run
from .problems import FieldError, Refused
from .records import insert_missing


def keep(session: Session, run: Run, spec: Spec) -> None:
    """Note what a new run begins from; `Refused` or `CreatureError` where it cannot."""
    names = named(spec)
    found = held(session, names)
    if isinstance(spec, Evolution):
        _refuse_unknown(names, found)
        genes_of(spec, [document(found[name]) for name in names])
    insert_missing(session, Origin, [{"run_id": run.id, "creature": name} for name in found])


def named(spec: Spec) -> Sequence[str]:
    """The creatures that a spec names."""
    if isinstance(spec, Evolution):
        return spec.search.origin
    return [spec.creature["sha256"]] if isinstance(spec, Refinement) else []


def held(session: Session, names: Sequence[str]) -> dict[str, Creature]:
    """Those that are there, by name in their order; none can go before the transaction ends."""
    if not names:
        return {}
    mine = select(Creature).where(Creature.sha256.in_(names)).order_by(Creature.sha256)
    rows = session.scalars(mine.with_for_update(read=True, key_share=True))
    return {row.sha256: row for row in rows}


def files(session: Session, names: Sequence[str]) -> list[dict[str, Any]]:
    """Creature files."""
    mine = select(Creature).where(Creature.sha256.in_(names)).order_by(Creature.sha256)
    return [document(row) for row in session.scalars(mine)] if names else []


def _refuse_unknown(names: Sequence[str], found: dict[str, Creature]) -> None:
    for name in names:
        if name not in found:
            needed = "names of creatures that are here; import it first"
            message = f"needs {needed}; got {name}"
            error = FieldError(field="search.origin", message=message, needed=needed, got=name)
            raise Refused(422, "Invalid input", f"search.origin: {message}", [error])
