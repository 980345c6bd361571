"""Replays: kept as files, made by the renderer when somebody wants to watch."""

import re
from typing import Any

from rq.job import JobStatus
from sqlalchemy import select
from sqlalchemy.orm import Session

from . import creatures
from .artifacts import replay_path
from .models import REPLAY, Artifact, Creature
from .records import insert_missing
from .services import Services

REFUSAL = re.compile(r"^[\w.]*CreatureError: ")
"""Before the words in which the engine refuses a replay; other errors say what they are."""
UNDERWAY = (JobStatus.QUEUED, JobStatus.STARTED, JobStatus.DEFERRED, JobStatus.SCHEDULED)


class RenderingFailed(Exception):
    """Why there is no replay."""


def find(session: Session, creature: str) -> Artifact | None:
    mine = (Artifact.creature == creature) & (Artifact.kind == REPLAY)
    return session.scalars(select(Artifact).where(mine)).one_or_none()


def order(services: Services, creature: str) -> None:
    """Have a replay made, once; `RenderingFailed` says why the last try gave none."""
    job = services.jobs.find(services.jobs.replay_id(creature))
    status = job.get_status(refresh=False) if job else None
    if status in UNDERWAY:
        return
    if job and status == JobStatus.FAILED:
        result = job.latest_result()
        text = (result.exc_string if result else None) or "the renderer ended without a word"
        raise RenderingFailed(REFUSAL.sub("", text.strip().splitlines()[-1]))
    services.jobs.render(creature)


def save(services: Services, creature: str, data: bytes) -> None:
    """Keep a replay that was made."""
    stored = services.artifacts.write(replay_path(creature), data)
    row = {
        "path": stored.path,
        "kind": REPLAY,
        "creature": creature,
        "size": stored.size,
        "sha256": stored.sha256,
    }
    with services.sessions.write.begin() as session:
        insert_missing(session, Artifact, [row])


def creature(services: Services, name: str) -> dict[str, Any]:
    """The creature file that a replay is made from."""
    with services.sessions.read() as session:
        return creatures.document(session.get_one(Creature, name))
