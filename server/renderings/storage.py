"""Renderings of creatures: find, enqueue, save and delete them."""

import json
import re
from typing import Any

from rq.job import Job, JobStatus
from sqlalchemy import ColumnElement, delete, select, update
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.viz.replay_file import REPLAY_VERSION

from ..core.database import insert_missing
from ..core.errors import ProblemError
from ..creatures import storage as creatures
from ..queue.jobs import FAILURE_SECONDS, FIRST
from ..services.services import Services
from ..storage.artifacts import rendering_path
from ..storage.garbage import discard
from ..tables import (
    AUDIT,
    GIF,
    LOOP,
    MP4,
    PREVIEW,
    REPLAY,
    STRIP,
    Artifact,
    Creature,
    InstallationState,
)

ENGINE_ERROR = re.compile(r"^[\w.]*(?:CreatureError|Missing|Broken): ")
"""Prefix to remove from the engine's own errors; others keep their class name."""
NOUNS = {AUDIT: "audit", STRIP: "picture", PREVIEW: "picture"}
NOUNS |= {FIRST: "first creature"}
NOUNS |= {GIF: "film", MP4: "film", LOOP: "film"}
VERSIONS = {REPLAY: REPLAY_VERSION}
"""Versions of formats that have changed: a rendering in an earlier one does not count."""
ANONYMOUS_LIMIT = 8
"""Length of the queue from which anonymous orders are not accepted for now."""
UNDERWAY = (JobStatus.QUEUED, JobStatus.STARTED, JobStatus.DEFERRED, JobStatus.SCHEDULED)


class RenderingFailed(ProblemError):
    """The renderer failed; the message says why, except to holders of a share.

    Errors may name files and hosts.
    """

    def __init__(self, kind: str, reason: str | None):
        why = f": {reason}" if reason else ""
        detail = f"The {NOUNS.get(kind, kind)} failed{why}. Try again in a minute."
        headers = {"Retry-After": str(FAILURE_SECONDS)}
        super().__init__(500, "Rendering failed", detail, headers=headers)


def find(session: Session, creature: str, kind: str = REPLAY) -> Artifact | None:
    found = session.scalars(select(Artifact).where(_matches(creature, kind))).one_or_none()
    return found if found and found.number == VERSIONS.get(kind) else None


def _matches(creature: str, kind: str) -> ColumnElement[bool]:
    return (Artifact.creature == creature) & (Artifact.kind == kind)


def enqueue(
    services: Services, creature: str, kind: str = REPLAY, *, anonymous: bool = False
) -> None:
    """Enqueue a rendering, once; raise `RenderingFailed` if the last try failed.

    An `anonymous` request goes last, and is not accepted while many wait.
    """
    job = services.jobs.find(services.jobs.rendering_id(creature, kind))
    if is_underway(job, kind, anonymous=anonymous):
        return
    if not (anonymous and services.jobs.renderings.count >= ANONYMOUS_LIMIT):
        services.jobs.render(creature, kind, anonymous=anonymous)


def is_underway(job: Job | None, kind: str, *, anonymous: bool = False) -> bool:
    """Tell whether a job waits or is computed; raise `RenderingFailed` if it failed."""
    status = job.get_status(refresh=False) if job else None
    if job and status == JobStatus.FAILED:
        result = job.latest_result()
        text = (result.exc_string if result else None) or "the renderer's process died"
        raise RenderingFailed(kind, None if anonymous else ENGINE_ERROR.sub("", _reason(text)))
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


def _reason(traceback: str) -> str:
    """Return the first line of the last error; its message may have many more."""
    lines = traceback.strip().splitlines()
    frames = [i for i, line in enumerate(lines) if line.startswith("  ")]
    return lines[min(frames[-1] + 1, len(lines) - 1)] if frames else lines[-1]


def save(services: Services, creature: str, kind: str, data: bytes) -> None:
    """Save a rendering in place of an earlier one."""
    stored = services.artifacts.write(rendering_path(creature, kind), data)
    row = {**vars(stored), "kind": kind, "number": VERSIONS.get(kind), "creature": creature}
    trusted = json.loads(data)["verdict"]["trusted"] if kind == AUDIT else None
    try:
        with services.sessions.write.begin() as session:
            _delete(session, creature, kind, trusted)
            insert_missing(session, Artifact, [row])
    except IntegrityError:  # The creature was deleted with its run meanwhile.
        services.artifacts.delete(stored.path)
        raise


def _delete(session: Session, creature: str, kind: str, trusted: bool | None = None) -> None:
    """Delete a rendering; `trusted` is the verdict of the audit that replaces an audit."""
    gone = delete(Artifact).where(_matches(creature, kind)).returning(Artifact.path)
    discard(session, list(session.scalars(gone)))
    if kind == AUDIT:
        audited = update(Creature).where(Creature.sha256 == creature)
        session.execute(audited.values(trusted=trusted))
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
