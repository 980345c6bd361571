"""Initial creatures of a run: check that they fit its spec, and record them."""

from collections.abc import Container, Sequence
from itertools import islice
from typing import Any
from uuid import UUID

from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive.initial import genes_of
from microcosmos.spec import Evolution, Refinement, Spec
from microcosmos.spec.creature import CreatureError

from ..core.database import insert_missing
from ..tables import Creature, InitialCreature
from .storage import document

COMPATIBILITY_FIELDS: Any = {
    "control": True,
    "genome": True,
    "body": True,
    "search": {"initial"},
}
"""The parts of a spec that decide whether it can start from creatures."""
ROWS = 10_000
"""Rows to insert at once: a sweep may have hundreds of thousands."""


def check(session: Session, spec: Spec) -> None:
    """Raise `CreatureError` if a spec cannot start from the creatures that it names.

    Creatures never change, so this needs no transaction that writes.
    """
    if isinstance(spec, Evolution) and spec.search.initial:
        rows = {row["sha256"]: row for row in files(session, spec.search.initial)}
        _refuse_missing(spec, rows)
        genes_of(spec, [rows[name] for name in spec.search.initial])


def record(session: Session, runs: Sequence[tuple[Spec, Sequence[UUID]]]) -> None:
    """Record the initial creatures of new runs, given by spec, so that none is deleted.

    Raise `CreatureError` if one is gone.
    """
    named = sorted({name for spec, _ in runs for name in initial_of(spec)})
    some = select(Creature.sha256).where(Creature.sha256.in_(named)).order_by(Creature.sha256)
    # Locked against deletion alone: others may read and lock the rows too. In one order, so
    # that two requests cannot deadlock. SQLite has one writer, and no such locks.
    locked = some.with_for_update(read=True, key_share=True)
    held = set(session.scalars(locked)) if named else set[str]()
    for spec, _ in runs:
        _refuse_missing(spec, held)
    rows = (
        {"run_id": run, "creature": name}
        for spec, run_ids in runs
        for run in run_ids
        for name in initial_of(spec)
        if name in held
    )
    while some_rows := list(islice(rows, ROWS)):
        insert_missing(session, InitialCreature, some_rows)


def initial_of(spec: Spec) -> Sequence[str]:
    if isinstance(spec, Evolution):
        return spec.search.initial
    return [spec.creature["sha256"]] if isinstance(spec, Refinement) else []


def files(session: Session, names: Sequence[str]) -> list[dict[str, Any]]:
    """Return the files of the creatures that exist."""
    some = select(Creature).where(Creature.sha256.in_(names)).order_by(Creature.sha256)
    return [document(row) for row in session.scalars(some)] if names else []


def _refuse_missing(spec: Spec, existing: Container[str]) -> None:
    missing = [name for name in initial_of(spec) if name not in existing]
    if missing and isinstance(spec, Evolution):
        needed = "names of creatures of this server (import it first)"
        raise CreatureError("search.initial", needed, missing[0])
