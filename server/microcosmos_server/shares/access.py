"""Authorise the holder of a share: find live shares, and read only what they show."""

import logging
import re
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy import Select, exists, select
from sqlalchemy.orm import Session

from microcosmos.archive import export
from microcosmos.sizes import size

from ..archives import elites
from ..core.database import insert_or_update
from ..core.errors import Gone, NotFound
from ..runs.curves import corrected_at
from ..services.services import Services
from ..storage import segments
from ..storage.artifacts import reason
from ..storage.garbage import begin_file, discard, keep_file
from ..tables import (
    CHECKPOINT,
    FINISHED,
    NORMAL,
    PUBLISHED,
    Artifact,
    Elite,
    Generation,
    Run,
    Share,
)
from .schemas import ShareState

log = logging.getLogger(__name__)

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


def lock(session: Session, slug: str) -> Share | None:
    """Return the share of a slug, as it is until the transaction ends."""
    return session.get(Share, slug, with_for_update=True) if SLUG.fullmatch(slug) else None


def find_live(session: Session, slug: str) -> Share:
    """Return a live share; raise `DomainError` 404 or 410."""
    share = find(session, slug)
    if share is None:
        raise NotFound("Nothing is shared at this address.")
    current = state(session, share)
    if current == "revoked":
        raise Gone("Its owner has revoked this share.")
    if current == "expired":
        detail = f"This share expired on {share.expires_at:%d %B %Y, %H:%M} UTC."
        raise Gone(detail)
    if share.run_id and session.get_one(Run, share.run_id).deleted_at:
        raise Gone("The shared run has been deleted.")
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
            raise NotFound(f"This share holds no run of the id {run_id}.")
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
        """Raise `DomainError` unless the share shows a creature, alone or as an elite."""
        share = self.share
        held = creature == share.creature
        if share.run_id:
            mine = (Elite.run_id == share.run_id) & (Elite.generation <= share.generation)
            entries = select(Elite.cell).where(mine, Elite.creature == creature).limit(1)
            held = session.scalars(entries).first() is not None
        if not held:
            detail = f"This share holds no creature of the name {creature}."
            raise NotFound(detail)

    def names(self, session: Session) -> list[str]:
        """Return the names of the creature, or of the elites, the best first."""
        share = self.share
        if share.run_id is None:
            return [share.cover]
        run = session.get_one(Run, share.run_id)
        archive = elites.as_of(run, share.generation or 0).order_by(None)
        found = session.execute(archive.order_by(Elite.fitness.desc(), Elite.creature))
        return list(dict.fromkeys(row.creature for row in found))

    def licensed(self, file: dict[str, Any]) -> dict[str, Any]:
        """Return a creature file under the share's licence, with the credit of both."""
        credit = list(dict.fromkeys([*file["credit"], *self.share.credit]))
        return {**file, "licence": self.share.licence, "credit": credit}

    def archive(self, session: Session) -> Artifact | None:
        return archive_file(session, self.share)


def open_share(services: Services, slug: str) -> LiveShare:
    """Return the read access of a live share; raise `DomainError` 404 or 410."""
    with services.sessions.read() as session:
        return LiveShare(find_live(session, slug))


def archive_path(share: Share) -> str:
    return f"shares/{share.slug}.h5"


def copy_checkpoint(services: Services, share: Share) -> None:
    """Copy the checkpoint of the shared generation, if there is one that is intact.

    A share that exists must not seem refused: on a full disk it has no file, until it is
    published again. The file may be large, so it is written outside any transaction.
    """
    with services.sessions.read() as session:
        mine = (Artifact.run_id == share.run_id) & (Artifact.kind == CHECKPOINT)
        same = select(Artifact).where(mine, Artifact.generation == share.generation)
        checkpoint = session.scalars(same.order_by(Artifact.number.desc()).limit(1)).first()
        copied = archive_file(session, share)
    try:
        if checkpoint is None or (copied and _is_stored(services, copied)):
            return
        if (length := segments.whole(checkpoint).size) > segments.LARGEST:
            log.warning("A share of run %s has no file: it has %s", share.run_id, size(length))
            return
        # Verified: a share must not publish a damaged file for good.
        data, _ = segments.read_intact(services.artifacts, checkpoint)
        licensed = export.licensed(data, share.licence, share.credit)
        begin_file(services.sessions, archive_path(share))
        stored = services.artifacts.write(archive_path(share), licensed)
    except (segments.Damaged, OSError) as error:
        why = reason(error) if isinstance(error, OSError) else error
        log.warning("A share of run %s has no file: %s", share.run_id, why)
        return
    of_run = {"run_id": share.run_id, "generation": share.generation}
    with services.sessions.write.begin() as session:
        current = lock(session, share.slug)
        if current and not current.revoked_at:
            row = {**vars(stored), "kind": PUBLISHED, **of_run}
            anew = {"size": stored.size, "sha256": stored.sha256}  # The store had lost it.
            insert_or_update(session, Artifact, [row], ["path"], anew)
            keep_file(session, stored.path)
        else:  # It was revoked, or its run was purged, while the file was written.
            discard(session, [stored.path])


def _is_stored(services: Services, file: Artifact) -> bool:
    return services.artifacts.sizes([file.path]).get(file.path) == file.size


def archive_file(session: Session, share: Share) -> Artifact | None:
    return session.get(Artifact, archive_path(share))
