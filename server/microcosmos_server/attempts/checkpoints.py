"""Checkpoints of a run: list, add and prune them, and return the run to one."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple
from uuid import UUID

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from ..core.database import insert_missing
from ..creatures.storage import creatures_of, mark_garbage
from ..runs.curves import corrected_at
from ..services.services import Services
from ..storage import segments
from ..storage.artifacts import StoredFile, superfluous
from ..storage.garbage import discard
from ..storage.segments import Written
from ..tables import CHECKPOINT, SEGMENT, Artifact, Elite, Generation, Result, Run


class CheckpointUnavailable(Exception):
    """The store has no intact file for a recorded checkpoint."""

    def __init__(self, row: Artifact, problem: str, path: str):
        super().__init__(
            f"The checkpoint of generation {row.generation} {problem}: no intact file "
            f"`{path}` in the store. Check "
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


class Intact(NamedTuple):
    """The newest intact checkpoint of a run, if it has one."""

    data: bytes | None = None
    row: Artifact | None = None
    damaged: tuple[str, ...] = ()
    """Paths of the newer ones, which are damaged."""
    segments: Mapping[str, StoredFile] = MappingProxyType({})
    """Its segments by SHA-256."""


def newest_intact(services: Services, run_id: UUID) -> Intact:
    """Return the newest checkpoint of which each file is intact.

    Raise `CheckpointUnavailable` if a file is missing, or if all are damaged.
    """
    with services.sessions.read() as session:
        rows = checkpoints(session, run_id)
    damaged: dict[str, str] = {}
    for row in rows:
        try:
            data, named = segments.read_intact(services.artifacts, row)
        except segments.Damaged as error:
            # No older checkpoint stands in for a missing file: behind a lost mount all are
            # missing, and falling back would delete what was recorded since.
            if error.missing:
                problem = "is missing" if error.path == row.path else "lacks a segment"
                raise CheckpointUnavailable(row, problem, error.path) from None
            damaged[row.path] = error.path
        else:
            return Intact(data, row, tuple(damaged), named)
    if rows:
        problem, path = "and all before it are damaged", damaged[rows[0].path]
        raise CheckpointUnavailable(rows[0], problem, path)
    return Intact()


def add_checkpoint(session: Session, run_id: UUID, generation: int, written: Written) -> None:
    """Make a written file the newest checkpoint, and discard superfluous ones.

    Segments stay as long as the run: a later checkpoint names those of the ones before it.
    """
    last, stored = last_checkpoint(session, run_id), written.file
    if last and last.path == stored.path:
        return
    of_run = {"kind": SEGMENT, "run_id": run_id, "generation": generation}
    insert_missing(session, Artifact, [{**vars(one), **of_run} for one in written.new])
    row = Artifact(
        path=stored.path,
        kind=CHECKPOINT,
        run_id=run_id,
        number=last.number + 1 if last and last.number is not None else 1,
        generation=generation,
        size=stored.size,
        sha256=stored.sha256,
        whole_size=written.whole.size if written.whole else None,
        whole_sha256=written.whole.sha256 if written.whole else None,
    )
    session.add(row)
    session.flush()
    kept = checkpoints(session, run_id)
    numbers = superfluous([one.number for one in kept if one.number is not None])
    gone = [one.path for one in kept if one.number in numbers]
    session.execute(delete(Artifact).where(Artifact.path.in_(gone)))
    discard(session, gone)


def fall_back(session: Session, run: Run, intact: Artifact, damaged: Sequence[str]) -> None:
    """Return to an intact checkpoint, and forget the damaged ones after it.

    Segments that were first recorded after it are deleted: the run computes them again and
    stores them under other names.
    """
    run.checkpoint_generation = intact.generation or 0
    session.execute(delete(Artifact).where(Artifact.path.in_(damaged)))
    later = (Artifact.kind == SEGMENT) & (Artifact.generation > run.checkpoint_generation)
    gone = delete(Artifact).where(Artifact.run_id == run.id, later).returning(Artifact.path)
    discard(session, list(session.scalars(gone)))
    rewind(session, run)


def rewind(session: Session, run: Run) -> bool:
    """Delete what was recorded after the checkpoint; return False if there was nothing."""
    last = run.checkpoint_generation
    if run.generation <= last:
        return False
    for table in (Elite, Result):
        later = (table.run_id == run.id, table.generation > last)
        # Before the rows go, which this query reads.
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
