"""What was published: who may see what of it, and until when."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from secrets import token_urlsafe
from typing import Any

from sqlalchemy import Select, exists, func, or_, select
from sqlalchemy.orm import Session

from ..archives import measures
from ..auth.authorize import refuse_other
from ..auth.principal import Principal
from ..core.database import clock
from ..core.errors import ProblemError
from ..core.schemas import FieldError
from ..runs.deps import find_run
from ..tables import FINISHED, Creature, Elite, Generation, Run, Share
from .schemas import ShareAsked, ShareState

BYTES = 24
"""Random ones in an address: nobody finds it by trying."""
SLUG = re.compile(r"[A-Za-z0-9_-]{1,43}")
MEANT = ("creature", "run_id", "generation", "title", "credit", "licence", "listed")


@dataclass(frozen=True)
class Subject:
    """What is published, and what its file says already."""

    cover: str
    title: str
    licence: str
    credit: Sequence[str]
    creature: str | None = None
    run: Run | None = None
    generation: int | None = None


def subject(session: Session, asked: ShareAsked, principal: Principal) -> Subject:
    """What somebody asks to publish; `ProblemError` where it is not there."""
    if asked.creature:
        row = session.get(Creature, asked.creature)
        if row is None:
            raise ProblemError(404, "Not found", f"No creature has the name {asked.creature}.")
        title = f"Creature {row.sha256[:8]}"
        return Subject(row.sha256, title, row.licence, row.credit, creature=row.sha256)
    assert asked.run is not None
    run = find_run(session, asked.run)
    refuse_other(session, principal, run, "publish")
    if not measures.searched(run):
        detail = f"A run of `{run.experiment}` fills no archive that could be published."
        raise ProblemError(422, "No archive", detail)
    generation = _last(run, asked.generation)
    best = session.get_one(Creature, _best(session, run, generation))
    title = run.name or f"Archive {str(run.id)[:8]}"
    return Subject(best.sha256, title, best.licence, [], run=run, generation=generation)


def _last(run: Run, asked: int | None) -> int:
    """The last generation that is seen: as the run's file has it, where none is named."""
    last = asked or run.checkpoint_generation or run.generation
    if last > run.generation:
        needed = f"at most {run.generation}, which the run has come to"
        detail = f"`generation` must be {needed}; got {last}."
        error = FieldError(field="generation", message=detail, needed=needed, got=last)
        raise ProblemError(422, "Invalid input", detail, [error])
    return last


def _best(session: Session, run: Run, generation: int) -> str:
    mine = (Elite.run_id == run.id) & (Elite.generation <= generation)
    ordered = select(Elite.creature).where(mine).order_by(Elite.fitness.desc(), Elite.cell)
    found = session.scalars(ordered.limit(1)).first()
    if found is None:
        raise ProblemError(409, "Nothing to publish", f"Run {run.id} has no elite yet.")
    return found


def publish(session: Session, asked: ShareAsked, principal: Principal) -> tuple[Share, bool]:
    """The share, and whether it is new: one that says the same and is live is taken again."""
    _refuse_past(session, asked.expires_at)
    of = subject(session, asked, principal)
    made = Share(
        slug=token_urlsafe(BYTES),
        creature=of.creature,
        run_id=of.run.id if of.run else None,
        generation=of.generation,
        cover=of.cover,
        title=asked.title or of.title,
        credit=list(dict.fromkeys([*of.credit, *asked.credit])),
        licence=asked.licence or of.licence,
        listed=asked.listed,
        expires_at=asked.expires_at,
        owner=principal.token,
    )
    mine = Share.owner.is_not_distinct_from(principal.token)
    for known in session.scalars(live().where(Share.cover == of.cover, mine)):
        same = all(getattr(known, name) == getattr(made, name) for name in MEANT)
        if same and known.expires_at == made.expires_at:
            return known, False
    session.add(made)
    session.flush()
    return made, True


def _refuse_past(session: Session, expires: datetime | None) -> None:
    now = session.execute(select(clock())).scalar_one()
    if expires is not None and expires <= now:
        needed = f"a moment to come; it is {now:%Y-%m-%dT%H:%M:%SZ}"
        detail = f"`expires_at` must be {needed}; got {expires.isoformat()}."
        error = FieldError(field="expires_at", message=detail, needed=needed, got=str(expires))
        raise ProblemError(422, "Invalid input", detail, [error])


def live() -> Select[Share]:
    """Shares that are neither revoked nor expired, and whose run does not lie in the bin."""
    lasting = or_(Share.expires_at.is_(None), Share.expires_at > clock())
    binned = exists().where(Run.id == Share.run_id, Run.deleted_at.is_not(None))
    return select(Share).where(Share.revoked_at.is_(None), lasting, ~binned)


def state(session: Session, share: Share) -> ShareState:
    if share.revoked_at:
        return "revoked"
    now = session.execute(select(clock())).scalar_one()
    return "expired" if share.expires_at and share.expires_at <= now else "live"


def find(session: Session, slug: str) -> Share | None:
    """The share of a name; what cannot be one, a database need not be able to read."""
    return session.get(Share, slug) if SLUG.fullmatch(slug) else None


def opened(session: Session, slug: str) -> Share:
    """The share at an address; `ProblemError` says that there is none, or none any more."""
    share = find(session, slug)
    if share is None:
        raise ProblemError(404, "Not found", "Nothing is shared at this address.")
    standing = state(session, share)
    if standing == "revoked":
        raise ProblemError(410, "Gone", "Whoever shared this has taken it back.")
    if standing == "expired":
        detail = f"This was shared until {share.expires_at:%d %B %Y, %H:%M} UTC."
        raise ProblemError(410, "Gone", detail)
    if share.run_id and session.get_one(Run, share.run_id).deleted_at:
        raise ProblemError(410, "Gone", "The run that was shared has been deleted.")
    return share


def holds(session: Session, share: Share, creature: str) -> bool:
    """Whether a creature is what was shared, or an elite of the archive that was."""
    if share.run_id is None:
        return creature == share.creature
    mine = (Elite.run_id == share.run_id) & (Elite.creature == creature)
    known = select(Elite.cell).where(mine, Elite.generation <= share.generation).limit(1)
    return session.scalars(known).first() is not None


def frozen(session: Session, share: Share) -> Run:
    """The run as it was when it was shared, without what its owner noted of it.

    It belongs to no session: nothing of it is ever written.
    """
    run = session.get_one(Run, share.run_id)
    last = session.get(Generation, (run.id, share.generation))
    figures = ("qd_score", "coverage", "best", "evaluations", "diverged", "seconds")
    return Run(
        id=run.id,
        experiment=run.experiment,
        spec=run.spec,
        version=run.version,
        demonstration=False,
        name=share.title,
        tags=[],
        status=FINISHED,
        created_at=run.created_at,
        queued_at=run.created_at,
        finished_at=share.created_at,
        attempt=0,
        device=run.device,
        generations=run.generations,
        generation=share.generation,
        **{name: getattr(last or run, name) for name in figures},
    )


def licensed(share: Share, document: Mapping[str, Any]) -> dict[str, Any]:
    """A creature file under the share's licence; who was named in it stays named."""
    credit = list(dict.fromkeys([*document["credit"], *share.credit]))
    return {**document, "licence": share.licence, "credit": credit}


def elites(session: Session, share: Share) -> int:
    """How many cells of a shared archive are filled."""
    mine = (Elite.run_id == share.run_id) & (Elite.generation <= share.generation)
    counted = select(func.count(Elite.cell.distinct())).where(mine)
    return session.execute(counted).scalar_one()
