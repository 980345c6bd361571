"""Renderings of creatures: find, enqueue, save and delete them."""

import json
from collections.abc import Callable
from typing import Any, TypeVar

from rq.job import Job, JobStatus
from sqlalchemy import ColumnElement, delete, select, update
from sqlalchemy.orm import Session

from ..core.database import insert_missing
from ..core.errors import Failed, FileLost, StoreUnavailable
from ..creatures import storage as creatures
from ..queue.jobs import FAILURE_SECONDS, KINDS, REASON
from ..services.services import Services
from ..storage import mark
from ..storage.artifacts import rendering_path
from ..storage.garbage import begin_file, discard, keep_file
from ..tables import AUDIT, REPLAY, Artifact, Creature, InstallationState

ANONYMOUS_LIMIT = 8
"""Queue length from which anonymous requests enqueue nothing."""
T = TypeVar("T")
UNDERWAY = (JobStatus.QUEUED, JobStatus.STARTED, JobStatus.DEFERRED, JobStatus.SCHEDULED)


class RenderingFailed(Failed):
    """The renderer failed; the message says why, except to holders of a share.

    Errors may name files and hosts.
    """

    def __init__(self, noun: str, reason: str | None):
        why = f": {reason}" if reason else ""
        detail = f"The {noun} failed{why}. Try again in a minute."
        headers = {"Retry-After": str(FAILURE_SECONDS)}
        super().__init__(detail, title="Rendering failed", headers=headers)


def find(session: Session, creature: str, kind: str = REPLAY) -> Artifact | None:
    found = session.scalars(select(Artifact).where(_matches(creature, kind))).one_or_none()
    return found if found and found.number == KINDS[kind].version else None


def read(
    services: Services,
    creature: str,
    kind: str,
    action: Callable[[Artifact], T],
) -> T | None:
    """Return what an action reads from a rendering; None without one.

    A rendering whose file the store has lost is forgotten, so that it can be made again. Those
    that people order are not: nothing would make them again, and the verdict of an audit holds
    without its file.
    """
    # Nobody may wait for a connection because the store is slow.
    with services.sessions.read() as session:
        found = find(session, creature, kind)
    try:
        return action(found) if found else None
    except FileLost:
        # Behind a lost mount every file is missing, and none is lost.
        if fault := mark.fault(services.sessions, services.artifacts):
            raise StoreUnavailable(fault) from None
        if KINDS[kind].ordered:
            if is_ordered(services, creature, kind):
                return None
            raise
    with services.sessions.write.begin() as writing:
        # Another one may have been saved meanwhile.
        if found and writing.get(Artifact, found.path, with_for_update=True):
            _delete(writing, creature, kind)
    return None


def _matches(creature: str, kind: str) -> ColumnElement[bool]:
    return (Artifact.creature == creature) & (Artifact.kind == kind)


def enqueue(
    services: Services, creature: str, kind: str = REPLAY, *, anonymous: bool = False
) -> None:
    """Enqueue a rendering, once; raise `RenderingFailed` if the last try failed.

    An `anonymous` request goes last, and is not accepted while many wait.
    """
    job = services.jobs.find(services.jobs.rendering_id(creature, kind))
    if is_underway(job, KINDS[kind].noun, anonymous=anonymous):
        return
    if not (anonymous and services.jobs.renderings.count >= ANONYMOUS_LIMIT):
        services.jobs.render(creature, kind, anonymous=anonymous)


def is_underway(job: Job | None, noun: str, *, anonymous: bool = False) -> bool:
    """Tell whether a job waits or is computed; raise `RenderingFailed` if it failed."""
    status = job.get_status(refresh=False) if job else None
    if job and status == JobStatus.FAILED:
        reason = job.meta.get(REASON, "the renderer's process died")
        raise RenderingFailed(noun, None if anonymous else reason)
    return status in UNDERWAY


def is_ordered(services: Services, creature: str, kind: str) -> bool:
    """Tell whether a rendering waits, is computed, or failed a moment ago."""
    return services.jobs.find(services.jobs.rendering_id(creature, kind)) is not None


def enqueue_again(services: Services, creature: str, kind: str) -> None:
    """Enqueue a rendering in place of an earlier one, unless it is underway."""
    job = services.jobs.find(services.jobs.rendering_id(creature, kind))
    if job is None or job.get_status(refresh=False) not in UNDERWAY:
        with services.sessions.write.begin() as session:
            _delete(session, creature, kind)
        services.jobs.render(creature, kind)


def save(services: Services, creature: str, kind: str, data: bytes) -> None:
    """Save a rendering in place of an earlier one."""
    # The file before its row, as for checkpoints: a row must not name a file that is not whole.
    path = rendering_path(creature, kind)
    begin_file(services.sessions, path)
    stored = services.artifacts.write(path, data)
    row = {**vars(stored), "kind": kind, "number": KINDS[kind].version, "creature": creature}
    trusted = json.loads(data)["verdict"]["trusted"] if kind == AUDIT else None
    # It fails if the creature was deleted with its run meanwhile.
    with services.sessions.write.begin() as session:
        _delete(session, creature, kind, trusted)
        insert_missing(session, Artifact, [row])
        if session.get(Artifact, path):  # Another renderer may have saved one at this moment.
            keep_file(session, path)


def _delete(session: Session, creature: str, kind: str, trusted: bool | None = None) -> None:
    """Delete a rendering; `trusted` is the verdict of the audit that replaces an audit."""
    gone = delete(Artifact).where(_matches(creature, kind)).returning(Artifact.path)
    discard(session, list(session.scalars(gone)))
    if kind == AUDIT:
        audited = update(Creature).where(Creature.sha256 == creature)
        session.execute(audited.values(trusted=trusted))
        # Archives show verdicts, and their kept answers hold until this count changes.
        counted = update(InstallationState)
        session.execute(counted.values(verdicts=InstallationState.verdicts + 1))


def existing(services: Services, creature: str, kind: str) -> bytes | None:
    """Return a rendering if it exists and is intact."""
    with services.sessions.read() as session:
        row = find(session, creature, kind)
    return services.artifacts.read_verified(row.path, row.sha256) if row else None


def creature(services: Services, name: str) -> dict[str, Any]:
    """Return the creature file that renderings start from."""
    with services.sessions.read() as session:
        return creatures.document(session.get_one(Creature, name))
