"""The log of a run: entries that are written in the transactions that change the run."""

from typing import Literal
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..tables import QUEUED, LogEntry, Run

Level = Literal["info", "warning", "error"]

SAVED, UNSAVED = "saved", "unsaved"
"""Kinds of frequent entries: each attempt keeps only the first and the last of a kind."""


def note(
    session: Session,
    run: Run,
    text: str,
    level: Level = "info",
    kind: str | None = None,
    details: str | None = None,
) -> None:
    """Write an entry. An attempt keeps only the first entry of a `kind` and this one."""
    entry = LogEntry(
        run_id=run.id, attempt=run.attempt, level=level, kind=kind, text=text, details=details
    )
    session.add(entry)
    session.flush()
    if kind is None:
        return
    same_kind = (
        LogEntry.run_id == run.id,
        LogEntry.attempt == run.attempt,
        LogEntry.kind == kind,
    )
    first = session.scalars(
        select(LogEntry.id).where(*same_kind).order_by(LogEntry.id).limit(1)
    ).one()
    # Insert before deleting: the new id is then higher than any that a client has read.
    session.execute(delete(LogEntry).where(*same_kind, LogEntry.id.not_in((first, entry.id))))


def note_status(session: Session, run: Run) -> None:
    """Log the status of a run after an attempt has ended."""
    queued = run.status == QUEUED
    text = "Queued for another attempt." if queued else f"{run.status.capitalize()}."
    note(session, run, text)


def note_start(session: Session, run: Run, before: int) -> None:
    """Log the start of an attempt, and the recorded generations that it discards.

    `before` is the last generation that was recorded before it.
    """
    last = run.checkpoint_generation
    place = f"from the checkpoint of generation {last}" if last else "from the beginning"
    note(session, run, f"Attempt {run.attempt} begins on worker {run.worker}, {place}.")
    if before > last:
        discarded = (
            f"generations {last + 1} to {before}"
            if before > last + 1
            else f"generation {before}"
        )
        note(session, run, f"Discarded {discarded}, recorded after the checkpoint.", "warning")


def read(session: Session, run_id: UUID, after: int | None, limit: int) -> list[LogEntry]:
    """Return the entries that follow an id, or the last ones, oldest first."""
    mine = select(LogEntry).where(LogEntry.run_id == run_id).limit(limit)
    if after is not None:
        return list(session.scalars(mine.where(LogEntry.id > after).order_by(LogEntry.id)))
    return list(session.scalars(mine.order_by(LogEntry.id.desc())))[::-1]
