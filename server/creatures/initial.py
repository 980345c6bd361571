"""Creatures that a run begins from: there, fit for its spec, and kept as long as the run is."""

from collections.abc import Container, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive.creature import CreatureError
from microcosmos.archive.initial import genes_of
from microcosmos.spec import Evolution, Refinement, Spec

from ..core.database import insert_missing
from ..tables import Creature, InitialCreature
from .storage import document

DECISIVE: Any = {"control": True, "genome": True, "body": True, "search": {"initial"}}
"""The parts of a spec that decide whether it can begin from creatures."""


def check(session: Session, spec: Spec) -> None:
    """Raise `CreatureError` where a spec cannot begin from what it names.

    Creatures never change: nobody who wants to write has to wait for it.
    """
    if isinstance(spec, Evolution) and spec.search.initial:
        rows = {row["sha256"]: row for row in files(session, spec.search.initial)}
        _refuse_lacking(spec, rows)
        genes_of(spec, [rows[name] for name in spec.search.initial])


def keep(session: Session, runs: Sequence[tuple[Spec, Sequence[UUID]]]) -> None:
    """Note what new runs begin from, which stays as long as they do; by spec, all at once.

    Raises `CreatureError` where it is gone.
    """
    held = _hold(session, sorted({name for spec, _ in runs for name in named(spec)}))
    for spec, run_ids in runs:
        _refuse_lacking(spec, held)
        names = [name for name in named(spec) if name in held]
        rows = [{"run_id": run, "creature": name} for run in run_ids for name in names]
        insert_missing(session, InitialCreature, rows)


def named(spec: Spec) -> Sequence[str]:
    """The creatures that a spec names."""
    if isinstance(spec, Evolution):
        return spec.search.initial
    return [spec.creature["sha256"]] if isinstance(spec, Refinement) else []


def files(session: Session, names: Sequence[str]) -> list[dict[str, Any]]:
    """Creature files."""
    mine = select(Creature).where(Creature.sha256.in_(names)).order_by(Creature.sha256)
    return [document(row) for row in session.scalars(mine)] if names else []


def _hold(session: Session, names: Sequence[str]) -> set[str]:
    """Those that are there; none can go before the transaction ends."""
    if not names:
        return set()
    mine = select(Creature.sha256).where(Creature.sha256.in_(names)).order_by(Creature.sha256)
    return set(session.scalars(mine.with_for_update(read=True, key_share=True)))


def _refuse_lacking(spec: Spec, there: Container[str]) -> None:
    """A refinement has its creature with it, a search only their names."""
    lacking = [name for name in named(spec) if name not in there]
    if lacking and isinstance(spec, Evolution):
        needed = "names of creatures that are here (import it first)"
        raise CreatureError("search.initial", needed, lacking[0])
