"""Publish a creature or an archive as a share."""

from secrets import token_urlsafe
from typing import Any

from sqlalchemy.orm import Session

from ..archives import elites, measures
from ..auth.authorize import refuse_non_owner
from ..auth.principal import Principal
from ..core.errors import ProblemError, invalid_field
from ..creatures.deps import find_creature
from ..runs.deps import find_run
from ..tables import Creature, Elite, Run, Share
from ..tables.base import refuse_past
from .access import live
from .schemas import ShareCreate

SLUG_BYTES = 24
COMPARED = (
    *("creature", "run_id", "generation", "title", "credit", "licence", "listed"),
    "expires_at",
)
"""Columns of a share's content: a share with the same values is reused."""


def share_columns(session: Session, sent: ShareCreate, principal: Principal) -> dict[str, Any]:
    """Return the columns of the shared content; raise `ProblemError` if it cannot be shared.

    Title, licence and credit are those of the file.
    """
    if sent.creature:
        row = find_creature(session, sent.creature)
        columns = {"creature": row.sha256, "title": f"Creature {row.sha256[:8]}"}
        return {**columns, "cover": row.sha256, "licence": row.licence, "credit": row.credit}
    assert sent.run is not None
    run = find_run(session, sent.run)
    refuse_non_owner(session, principal, run, "publish")
    if not measures.has_archive(run):
        detail = f"A run of `{run.experiment}` has no archive to publish."
        raise ProblemError(422, "No archive", detail)
    # By default the last generation of the run's file.
    generation = sent.generation or run.checkpoint_generation or run.generation
    if generation > run.generation:
        needed = f"at most {run.generation}, the run's last one"
        raise invalid_field("generation", needed, generation)
    best = session.get_one(Creature, _best(session, run, generation))
    columns = {"run_id": run.id, "generation": generation}
    columns |= {"title": run.name or f"Archive {str(run.id)[:8]}"}
    return {**columns, "cover": best.sha256, "licence": best.licence, "credit": []}


def _best(session: Session, run: Run, generation: int) -> str:
    there = elites.as_of(run, generation).order_by(None)
    found = session.execute(there.order_by(Elite.fitness.desc(), Elite.cell).limit(1)).first()
    if found is None:
        raise ProblemError(409, "Nothing to publish", f"Run {run.id} has no elite yet.")
    return found.creature


def publish(session: Session, sent: ShareCreate, principal: Principal) -> tuple[Share, bool]:
    """Return the share and whether it is new: reuse a live one with the same content."""
    refuse_past(session, sent.expires_at)
    new = Share(
        slug=token_urlsafe(SLUG_BYTES),
        listed=sent.listed,
        expires_at=sent.expires_at,
        owner=principal.token,
        **share_columns(session, sent, principal),
    )
    new.title, new.licence = sent.title or new.title, sent.licence or new.licence
    new.credit = list(dict.fromkeys([*new.credit, *sent.credit]))
    mine = Share.owner.is_not_distinct_from(principal.token)
    for known in session.scalars(live().where(Share.cover == new.cover, mine)):
        if all(getattr(known, name) == getattr(new, name) for name in COMPARED):
            return known, False
    session.add(new)
    session.flush()
    return new, True
