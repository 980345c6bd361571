"""Checkpoints of a run: list, add and prune them, and return the run to one."""

from collections.abc import Sequence
from hashlib import sha256
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..creatures.storage import creatures_of, mark_garbage
from ..runs.curves import corrected_at
from ..services.services import Services
from ..storage.artifacts import StoredFile, superfluous
from ..storage.garbage import discard
from ..tables import CHECKPOINT, Artifact, Elite, Generation, Result, Run


class CheckpointUnavailable(Exception):
    """The store has no intact file for a recorded checkpoint."""

    def __init__(self, services: Services, row: Artifact, problem: str):
        super().__init__(
            f"The checkpoint of generation {row.generation} {problem}: no intact file "
            f"`{row.path}` in {services.artifacts.location}. Check "
            "MICROCOSMOS_ARTIFACTS_URL and the folder's mount, or restore the file"
        )


def last_checkpoint(session: Session, run_id: UUID) -> Artifact | None:
    """Return the newest checkpoint: runs resume from it and people download it."""
    return next(iter(checkpoints(session, run_id, 1)), None)


def checkpoints(session: Session, run_id: UUID, limit: int | None = None) -> list[Artifact]:
    """Return the checkpoints of a run, the newest first."""
    mine = (Artifact.run_id == run_id) & (Artifact.kind == CHECKPOINT)
    newest = select(Artifact).where(mine).order_by(Artifact.number.desc()).limit(limit)
    return list(session.scalars(newest))


def newest_intact(
    services: Services, run_id: UUID
) -> tuple[bytes | None, Artifact | None, list[str]]:
    """Return content and row of the newest intact checkpoint, and damaged paths after it."""
    with services.sessions.read() as session:
        rows = checkpoints(session, run_id)
    damaged: list[str] = []
    for row in rows:
        try:
            data = services.artifacts.read(row.path)
        except FileNotFoundError:
            raise CheckpointUnavailable(services, row, "is missing") from None
        if sha256(data).hexdigest() == row.sha256:
            return data, row, damaged
        damaged.append(row.path)
    if rows:
        raise CheckpointUnavailable(services, rows[0], "and all before it are damaged")
    return None, None, []


def add_checkpoint(session: Session, run_id: UUID, generation: int, stored: StoredFile) -> None:
    """Make a written file the newest checkpoint, and discard superfluous ones."""
    last = last_checkpoint(session, run_id)
    if last and last.path == stored.path:
        return
    row = Artifact(
        path=stored.path,
        kind=CHECKPOINT,
        run_id=run_id,
        number=last.number + 1 if last and last.number is not None else 1,
        generation=generation,
        size=stored.size,
        sha256=stored.sha256,
    )
    session.add(row)
    session.flush()
    kept = checkpoints(session, run_id)
    numbers = superfluous([one.number for one in kept if one.number is not None])
    gone = [one.path for one in kept if one.number in numbers]
    session.execute(delete(Artifact).where(Artifact.path.in_(gone)))
    discard(session, gone)


def fall_back(session: Session, run: Run, intact: Artifact, damaged: Sequence[str]) -> None:
    """Return to a checkpoint whose file is intact, and forget the damaged ones after it."""
    session.execute(delete(Artifact).where(Artifact.path.in_(damaged)))
    run.checkpoint_generation = intact.generation or 0
    rewind(session, run)


def rewind(session: Session, run: Run) -> bool:
    """Delete what was recorded after the checkpoint; return False if there was nothing."""
    last = run.checkpoint_generation
    if run.generation <= last:
        return False
    for table in (Elite, Result):
        later = (table.run_id == run.id, table.generation > last)
        mark_garbage(session, run.id, creatures_of(table).where(*later))
    for table in (Elite, Result, Generation):
        session.execute(delete(table).where(table.run_id == run.id, table.generation > last))
    kept = session.get(Generation, (run.id, last))
    for column in ("qd_score", "coverage", "best"):
        setattr(run, column, getattr(kept, column, None))
    for column in ("generation", "evaluations", "infeasible", "seconds"):
        setattr(run, column, getattr(kept, column, 0))
    summaries = (Generation.run_id == run.id) & Generation.summary.is_not(None)
    newest = select(Generation.summary).where(summaries).order_by(Generation.generation.desc())
    run.summary = session.scalars(newest.limit(1)).one_or_none()
    run.rewinds += 1
    for name, value in corrected_at(session, run.id, last).items():
        setattr(run, name, value)
    return True
