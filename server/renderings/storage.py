"""Renderings of creatures: kept as files, made by the renderer when somebody wants them."""

import re
from typing import Any

from rq.job import JobStatus
from sqlalchemy import delete, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from microcosmos.viz.replay_file import REPLAY_VERSION

from ..core.database import insert_missing
from ..creatures import storage as creatures
from ..services.services import Services
from ..storage.artifacts import Stored, rendering_path
from ..tables import REPLAY, Artifact, Creature

REFUSAL = re.compile(r"^[\w.]*(?:CreatureError|Missing|Broken): ")
"""Before the words in which the engine refuses a creature; other errors say what they are."""
VERSIONS = {REPLAY: REPLAY_VERSION}
"""Of formats that have changed: what was kept in an earlier one counts as not there."""
STRANGERS = 8
"""Renderings that may wait before strangers' orders are put off."""
UNDERWAY = (JobStatus.QUEUED, JobStatus.STARTED, JobStatus.DEFERRED, JobStatus.SCHEDULED)


class RenderingFailed(Exception):
    """Why there is no such rendering."""


def find(session: Session, creature: str, kind: str = REPLAY) -> Artifact | None:
    mine = (Artifact.creature == creature) & (Artifact.kind == kind)
    found = session.scalars(select(Artifact).where(mine)).one_or_none()
    return found if found and found.number == VERSIONS.get(kind) else None


def order(
    services: Services, creature: str, kind: str = REPLAY, *, anonymous: bool = False
) -> None:
    """Have a rendering made, once; `RenderingFailed` says why the last try gave none.

    An `anonymous` order waits behind all others, and is put off where many wait already.
    """
    job = services.jobs.find(services.jobs.rendering_id(creature, kind))
    status = job.get_status(refresh=False) if job else None
    if status in UNDERWAY:
        return
    if job and status == JobStatus.FAILED:
        result = job.latest_result()
        text = (result.exc_string if result else None) or "the renderer ended without a word"
        raise RenderingFailed(REFUSAL.sub("", _reason(text)))
    if not (anonymous and services.jobs.renderings.count >= STRANGERS):
        services.jobs.render(creature, kind, anonymous=anonymous)


def underway(services: Services, creature: str, kind: str) -> bool:
    """Whether a rendering was ordered and is not there yet."""
    job = services.jobs.find(services.jobs.rendering_id(creature, kind))
    return job is not None and job.get_status(refresh=False) in UNDERWAY


def forget(services: Services, creature: str, kind: str) -> None:
    """Have a rendering that is kept made anew, the next time that it is ordered."""
    mine = (Artifact.creature == creature) & (Artifact.kind == kind)
    with services.sessions.write.begin() as session:
        session.execute(delete(Artifact).where(mine))


def _reason(traceback: str) -> str:
    """The first line of what was raised last; its message may go on for many more."""
    said = traceback.strip().splitlines()
    frames = [i for i, line in enumerate(said) if line.startswith("  ")]
    return said[min(frames[-1] + 1, len(said) - 1)] if frames else said[-1]


def save(services: Services, creature: str, kind: str, data: bytes) -> None:
    """Keep a rendering that was made, in place of an earlier one."""
    stored = services.artifacts.write(rendering_path(creature, kind), data)
    row = {
        "path": stored.path,
        "kind": kind,
        "number": VERSIONS.get(kind),
        "creature": creature,
        "size": stored.size,
        "sha256": stored.sha256,
    }
    try:
        with services.sessions.write.begin() as session:
            mine = (Artifact.creature == creature) & (Artifact.kind == kind)
            session.execute(delete(Artifact).where(mine))
            insert_missing(session, Artifact, [row])
    except IntegrityError:  # The creature has gone with its run meanwhile.
        services.artifacts.delete(stored.path)
        raise


def kept(services: Services, creature: str, kind: str) -> bytes | None:
    """A rendering that is there already and sound."""
    with services.sessions.read() as session:
        row = find(session, creature, kind)
    return services.artifacts.sound(Stored(row.path, row.size, row.sha256)) if row else None


def creature(services: Services, name: str) -> dict[str, Any]:
    """The creature file that renderings are made from."""
    with services.sessions.read() as session:
        return creatures.document(session.get_one(Creature, name))
