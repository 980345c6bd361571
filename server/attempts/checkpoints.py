"""Which files are a run's checkpoints, which of them can go, and how a run returns to one."""

from collections.abc import Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..creatures.storage import mark_garbage, named
from ..storage.artifacts import Stored, superfluous
from ..tables import CHECKPOINT, Artifact, Elite, Generation, Result, Run


def last_checkpoint(session: Session, run_id: UUID) -> Artifact | None:
    """Return the newest checkpoint: runs resume from it and people download it."""
    return next(iter(checkpoints(session, run_id, 1)), None)


def checkpoints(session: Session, run_id: UUID, limit: int | None = None) -> list[Artifact]:
    """Return the checkpoints of a run, the newest first."""
    mine = (Artifact.run_id == run_id) & (Artifact.kind == CHECKPOINT)
    newest = select(Artifact).where(mine).order_by(Artifact.number.desc()).limit(limit)
    return list(session.scalars(newest))


def point_at(session: Session, run_id: UUID, generation: int, stored: Stored) -> list[str]:
    """Make a written file the newest checkpoint: paths of the files that nothing needs now."""
    last = last_checkpoint(session, run_id)
    if last and last.path == stored.path:
        return []
    number = last.number + 1 if last and last.number is not None else 1
    row = Artifact(
        path=stored.path,
        kind=CHECKPOINT,
        run_id=run_id,
        number=number,
        generation=generation,
        size=stored.size,
        sha256=stored.sha256,
    )
    session.add(row)
    session.flush()
    return _prune(session, run_id)


def _prune(session: Session, run_id: UUID) -> list[str]:
    mine = (Artifact.run_id == run_id) & (Artifact.kind == CHECKPOINT)
    numbers = [n for n in session.scalars(select(Artifact.number).where(mine)) if n is not None]
    gone = delete(Artifact).where(mine, Artifact.number.in_(superfluous(numbers)))
    return list(session.scalars(gone.returning(Artifact.path)))


def fall_back(session: Session, run: Run, sound: Artifact, damaged: Sequence[str]) -> None:
    """Return to a checkpoint whose file is sound, and forget the damaged ones after it."""
    session.execute(delete(Artifact).where(Artifact.path.in_(damaged)))
    run.checkpoint_generation = sound.generation or 0
    rewind(session, run)


def rewind(session: Session, run: Run) -> bool:
    """Forget what was recorded beyond the checkpoint: whether there was anything."""
    last = run.checkpoint_generation
    if run.generation <= last:
        return False
    mark_garbage(session, run.id, *(named(run.id, table, last) for table in (Elite, Result)))
    for table in (Elite, Result, Generation):
        session.execute(delete(table).where(table.run_id == run.id, table.generation > last))
    kept = session.get(Generation, (run.id, last))
    for column in ("qd_score", "coverage", "best"):
        setattr(run, column, getattr(kept, column, None))
    for column in ("generation", "evaluations", "diverged", "seconds"):
        setattr(run, column, getattr(kept, column, 0))
    run.summary = _summary(session, run.id)
    return True


def _summary(session: Session, run_id: UUID) -> dict[str, Any] | None:
    """The newest that is recorded."""
    told = (Generation.run_id == run_id) & Generation.summary.is_not(None)
    newest = select(Generation.summary).where(told).order_by(Generation.generation.desc())
    return session.scalars(newest.limit(1)).one_or_none()
