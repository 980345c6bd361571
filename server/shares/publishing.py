"""Shares in the database: publish, open, and read what they show."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from secrets import token_urlsafe
from typing import Any

from sqlalchemy import Select, exists, func, select
from sqlalchemy.orm import Session

from ..archives import measures
from ..auth.authorize import refuse_other
from ..auth.principal import Principal
from ..core.errors import ProblemError, invalid_field
from ..creatures.deps import find_creature
from ..runs.deps import find_run
from ..tables import FINISHED, Creature, Elite, Generation, Run, Share
from ..tables.base import refuse_past
from .schemas import ShareCreate, ShareState

SLUG_BYTES = 24
SLUG = re.compile(r"[A-Za-z0-9_-]{1,43}")
COMPARED = (
    *("creature", "run_id", "generation", "title", "credit", "licence", "listed"),
    "expires_at",
)
"""Two shares with the same values are one."""


@dataclass(frozen=True)
class Subject:
    """A creature or an archive to share, and what its file says already."""

    cover: str
    title: str
    licence: str
    credit: Sequence[str]
    creature: str | None = None
    run: Run | None = None
    generation: int | None = None


def subject(session: Session, sent: ShareCreate, principal: Principal) -> Subject:
    """Return the subject of a request; raise `ProblemError` if it cannot be shared."""
    if sent.creature:
        row = find_creature(session, sent.creature)
        title = f"Creature {row.sha256[:8]}"
        return Subject(row.sha256, title, row.licence, row.credit, creature=row.sha256)
    assert sent.run is not None
    run = find_run(session, sent.run)
    refuse_other(session, principal, run, "publish")
    if not measures.has_archive(run):
        detail = f"A run of `{run.experiment}` has no archive to publish."
        raise ProblemError(422, "No archive", detail)
    generation = _last(run, sent.generation)
    best = session.get_one(Creature, _best(session, run, generation))
    title = run.name or f"Archive {str(run.id)[:8]}"
    return Subject(best.sha256, title, best.licence, [], run=run, generation=generation)


def _last(run: Run, requested: int | None) -> int:
    """Return the last generation to show: by default that of the run's file."""
    last = requested or run.checkpoint_generation or run.generation
    if last > run.generation:
        raise invalid_field("generation", f"at most {run.generation}, the run's last one", last)
    return last


def _best(session: Session, run: Run, generation: int) -> str:
    mine = (Elite.run_id == run.id) & (Elite.generation <= generation)
    ordered = select(Elite.creature).where(mine).order_by(Elite.fitness.desc(), Elite.cell)
    found = session.scalars(ordered.limit(1)).first()
    if found is None:
        raise ProblemError(409, "Nothing to publish", f"Run {run.id} has no elite yet.")
    return found


def publish(session: Session, sent: ShareCreate, principal: Principal) -> tuple[Share, bool]:
    """Return the share and whether it is new: reuse a live one with the same content."""
    refuse_past(session, sent.expires_at)
    of = subject(session, sent, principal)
    new = Share(
        slug=token_urlsafe(SLUG_BYTES),
        creature=of.creature,
        run_id=of.run.id if of.run else None,
        generation=of.generation,
        cover=of.cover,
        title=sent.title or of.title,
        credit=list(dict.fromkeys([*of.credit, *sent.credit])),
        licence=sent.licence or of.licence,
        listed=sent.listed,
        expires_at=sent.expires_at,
        owner=principal.token,
    )
    mine = Share.owner.is_not_distinct_from(principal.token)
    for known in session.scalars(live().where(Share.cover == of.cover, mine)):
        if all(getattr(known, name) == getattr(new, name) for name in COMPARED):
            return known, False
    session.add(new)
    session.flush()
    return new, True


def live() -> Select[Share]:
    """Select shares that are live and whose run is not in the bin."""
    in_bin = exists().where(Run.id == Share.run_id, Run.deleted_at.is_not(None))
    return select(Share).where(Share.live(), ~in_bin)


def state(session: Session, share: Share) -> ShareState:
    if share.revoked_at:
        return "revoked"
    return "expired" if share.expired(session) else "live"


def find(session: Session, slug: str) -> Share | None:
    """Return the share of a slug, if there is one; some databases refuse other texts."""
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


def holds(session: Session, share: Share, creature: str) -> bool:
    """Return whether a creature is the shared one, or an elite of the shared archive."""
    if share.run_id is None:
        return creature == share.creature
    mine = (Elite.run_id == share.run_id) & (Elite.creature == creature)
    known = select(Elite.cell).where(mine, Elite.generation <= share.generation).limit(1)
    return session.scalars(known).first() is not None


def run_as_shared(session: Session, share: Share) -> Run:
    """Return the run as it was when it was shared, without its owner's notes.

    The object belongs to no session, so nothing of it is ever written.
    """
    run = session.get_one(Run, share.run_id)
    last = session.get(Generation, (run.id, share.generation))
    copied = ("id", "experiment", "spec", "version", "created_at", "device", "generations")
    figures = ("qd_score", "coverage", "best", "evaluations", "diverged", "seconds")
    return Run(
        demonstration=False,
        name=share.title,
        tags=[],
        status=FINISHED,
        queued_at=run.created_at,
        finished_at=share.created_at,
        attempt=0,
        generation=share.generation,
        **{name: getattr(run, name) for name in copied},
        **{name: getattr(last or run, name) for name in figures},
    )


def licensed(share: Share, document: Mapping[str, Any]) -> dict[str, Any]:
    """Return a creature file under the share's licence, with the credit of both."""
    credit = list(dict.fromkeys([*document["credit"], *share.credit]))
    return {**document, "licence": share.licence, "credit": credit}


def elites(session: Session, share: Share) -> int:
    """Return the number of filled cells of a shared archive."""
    mine = (Elite.run_id == share.run_id) & (Elite.generation <= share.generation)
    counted = select(func.count(Elite.cell.distinct())).where(mine)
    return session.execute(counted).scalar_one()
