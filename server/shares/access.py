"""Authorise the holder of a share: find live shares, and read only what they show."""

import re
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Select, exists, select
from sqlalchemy.orm import Session

from ..archives import elites
from ..core.errors import ProblemError
from ..runs.curves import corrected_at
from ..services.services import Services
from ..tables import FINISHED, NORMAL, Artifact, Elite, Generation, Run, Share
from . import archive_files
from .schemas import ShareState

SLUG = re.compile(r"[A-Za-z0-9_-]{1,43}")


def live() -> Select[Share]:
    """Select shares that are live and whose run is not in the bin."""
    in_bin = exists().where(Run.id == Share.run_id, Run.deleted_at.is_not(None))
    return select(Share).where(Share.live(), ~in_bin)


def state(session: Session, share: Share) -> ShareState:
    if share.revoked_at:
        return "revoked"
    return "expired" if share.expired(session) else "live"


def find(session: Session, slug: str) -> Share | None:
    """Return the share of a slug, if any. Some databases refuse malformed slugs."""
    return session.get(Share, slug) if SLUG.fullmatch(slug) else None


def find_live(session: Session, slug: str) -> Share:
    """Return a live share; raise `ProblemError` 404 or 410."""
    share = find(session, slug)
    if share is None:
        raise ProblemError(404, "Not found", "Nothing is shared at this address.")
    current = state(session, share)
    if current == "revoked":
        raise ProblemError(410, "Gone", "Its owner has revoked this share.")
    if current == "expired":
        detail = f"This share expired on {share.expires_at:%d %B %Y, %H:%M} UTC."
        raise ProblemError(410, "Gone", detail)
    if share.run_id and session.get_one(Run, share.run_id).deleted_at:
        raise ProblemError(410, "Gone", "The shared run has been deleted.")
    return share


@dataclass(frozen=True)
class LiveShare:
    """Read access to what a live share shows."""

    share: Share

    @property
    def listed(self) -> bool:
        return self.share.listed

    def run(self, session: Session, run_id: UUID) -> Run:
        """Return the run as it was when it was shared, without its owner's notes.

        The object belongs to no session, so nothing of it is ever written.
        """
        share = self.share
        if share.run_id is None or run_id != share.run_id:
            raise ProblemError(404, "Not found", f"This share holds no run of the id {run_id}.")
        run = session.get_one(Run, run_id)
        last = session.get(Generation, (run_id, share.generation))
        copied = ("id", "experiment", "spec", "version", "created_at", "device")
        copied = (*copied, "generations", "rewinds")
        figures = ("qd_score", "coverage", "best", "evaluations", "infeasible", "seconds")
        return Run(
            demonstration=False,
            name=share.title,
            tags=[],
            priority=NORMAL,
            labels=[],
            may_yield=False,
            status=FINISHED,
            queued_at=run.created_at,
            finished_at=share.created_at,
            attempt=0,
            generation=share.generation,
            **{name: getattr(run, name) for name in copied},
            **{name: getattr(last or run, name) for name in figures},
            **corrected_at(session, run_id, share.generation or 0),
        )

    def refuse_unless_holds(self, session: Session, creature: str) -> None:
        """Raise `ProblemError` unless the share shows a creature, alone or as an elite."""
        share = self.share
        held = creature == share.creature
        if share.run_id:
            mine = (Elite.run_id == share.run_id) & (Elite.generation <= share.generation)
            entries = select(Elite.cell).where(mine, Elite.creature == creature).limit(1)
            held = session.scalars(entries).first() is not None
        if not held:
            detail = f"This share holds no creature of the name {creature}."
            raise ProblemError(404, "Not found", detail)

    def names(self, session: Session) -> list[str]:
        """Return the names of the creature, or of the elites, the best first."""
        share = self.share
        if share.run_id is None:
            return [share.cover]
        run = session.get_one(Run, share.run_id)
        there = elites.as_of(run, share.generation or 0).order_by(None)
        found = session.execute(there.order_by(Elite.fitness.desc(), Elite.creature))
        return list(dict.fromkeys(row.creature for row in found))

    def licensed(self, file: dict[str, Any]) -> dict[str, Any]:
        """Return a creature file under the share's licence, with the credit of both."""
        credit = list(dict.fromkeys([*file["credit"], *self.share.credit]))
        return {**file, "licence": self.share.licence, "credit": credit}

    def archive(self, session: Session) -> Artifact:
        found = archive_files.find(session, self.share)
        if found is None:
            generation = self.share.generation
            detail = f"The share has no file of generation {generation}; its elites are shown."
            raise ProblemError(404, "No file", detail)
        return found


def open_share(services: Services, slug: str) -> LiveShare:
    """Return the read access of a live share; raise `ProblemError` 404 or 410."""
    with services.sessions.read() as session:
        return LiveShare(find_live(session, slug))
