"""Routes of shares: publish, read, list, revoke."""

from collections.abc import Callable
from secrets import token_urlsafe
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from pydantic import StringConstraints
from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from microcosmos.archive import export
from microcosmos.naming import LICENCE
from microcosmos.spec.base import Digest

from ..archives import elites, measures
from ..auth.authorize import PUBLIC, Reader, Writer, authorize_owner, refuse_non_owner
from ..auth.principal import ADMIN, Principal
from ..core.api import Answers, sends
from ..core.database import now
from ..core.errors import Conflict, Invalid, NotFound, invalid_field
from ..core.json_body import json_route
from ..core.paging import MOMENT, Order
from ..creatures import storage as creatures
from ..creatures.deps import find_creature
from ..queue.jobs import KINDS
from ..renderings import responses
from ..renderings.responses import Rendering
from ..runs.deps import find_run
from ..services.services import ServicesDep, SessionDep
from ..storage.garbage import discard
from ..tables import LOOP, PREVIEW, Creature, Elite, Run, Share
from ..tables.base import refuse_past
from . import access, page
from .access import live
from .page import public_address
from .schemas import ShareCreate, SharedCreatures, SharePage, ShareRead, Terms

# 192 random bits: the address of a share is its only protection.
SLUG_BYTES = 24
COMPARED = (
    *("creature", "run_id", "generation", "title", "credit", "licence"),
    *Terms.model_fields,
)
"""Columns of a share's content: a share with the same values is reused."""


def share_columns(session: Session, sent: ShareCreate, principal: Principal) -> dict[str, Any]:
    """Return the columns of the shared content; raise `DomainError` if it cannot be shared.

    Title, licence and credit are those of the file, or of all elites of an archive.
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
        raise Invalid(detail, title="No archive")
    # By default the last generation of the run's file.
    generation = sent.generation or run.checkpoint_generation or run.generation
    if generation > run.generation:
        needed = f"at most {run.generation}, the run's last one"
        raise invalid_field("generation", needed, generation)
    best, terms = _best(session, run, generation), _terms(session, run, generation)
    columns = {"run_id": run.id, "generation": generation}
    columns |= {"title": run.name or f"Archive {str(run.id)[:8]}"}
    return {**columns, "cover": best, "licence": LICENCE, "credit": [], **terms}


def _best(session: Session, run: Run, generation: int) -> str:
    archive = elites.as_of(run, generation).order_by(None)
    found = session.execute(archive.order_by(Elite.fitness.desc(), Elite.cell).limit(1)).first()
    if found is None:
        raise Conflict(f"Run {run.id} has no elite yet.", title="Nothing to publish")
    return found.creature


def _terms(session: Session, run: Run, generation: int) -> export.Terms:
    archive = elites.as_of(run, generation).order_by(None)
    columns = Creature.licence, Creature.credit
    found = archive.with_only_columns(*columns, maintain_column_froms=True)
    rows = session.execute(found.order_by(Creature.sha256))
    return export.joint_terms({"licence": row.licence, "credit": row.credit} for row in rows)


def find_or_add(
    session: Session, sent: ShareCreate, principal: Principal
) -> tuple[Share, bool]:
    """Return the share and whether it is new: reuse a live one with the same content."""
    refuse_past(session, sent.expires_at)
    new = Share(
        slug=token_urlsafe(SLUG_BYTES),
        owner=principal.token,
        **{name: getattr(sent, name) for name in Terms.model_fields},
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


BODY_BYTES = 1 << 16
Limit = Annotated[int, Query(ge=1, le=200)]
Slug = Annotated[str, Path(pattern=f"^{access.SLUG.pattern}$")]
SlugText = Annotated[str, StringConstraints(pattern=f"^{access.SLUG.pattern}$")]
NEWEST_FIRST = Order("-created", Share.created_at.expression, MOMENT, Share.slug, SlugText)

router = APIRouter(tags=["shares"], route_class=json_route(BODY_BYTES))


@router.post("/shares", status_code=201, responses={200: {"model": ShareRead}})
def publish(
    principal: Writer,
    sent: ShareCreate,
    request: Request,
    services: ServicesDep,
    response: Response,
) -> ShareRead:
    """Publish a creature or an archive. A live share with the same content is returned, 200."""
    with services.sessions.write.begin() as session:
        share, new = find_or_add(session, sent, principal)
        read = share_read(request, session, share)
    if share.run_id:
        access.copy_checkpoint(services, share)
    page.order_previews(services, share.cover)
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/v1/shares/{share.slug}"
    return read


def share(request: Request, slug: Slug, session: SessionDep) -> Share:
    found = access.find_live(session, slug)
    request.state.listed = found.listed
    return found


ShareDep = Annotated[Share, Depends(share)]
PENDING: Answers = {202: {"model": Rendering}}


@router.get("/shares/{slug}", dependencies=[PUBLIC])
def read_share(request: Request, share: ShareDep, session: SessionDep) -> ShareRead:
    return share_read(request, session, share)


@router.get("/shares/{slug}/creature.json", dependencies=[PUBLIC])
def read_shared_creature(
    share: ShareDep,
    session: SessionDep,
    creature: Digest | None = None,
    ancestors: bool = True,
) -> dict[str, Any]:
    """Return the file of a creature for import, by default the best, with its ancestors.

    Pages of other installations may read it.
    """
    live, name = access.LiveShare(share), creature or share.cover
    live.refuse_unless_holds(session, name)
    row = find_creature(session, name)
    file = creatures.with_ancestors(session, row) if ancestors else creatures.document(row)
    return live.licensed(file)


@router.get("/shares/{slug}/creatures.json", dependencies=[PUBLIC])
def read_shared_creatures(share: ShareDep, session: SessionDep) -> SharedCreatures:
    """Return the names of a share's creatures for import, the best first.

    Pages of other installations may read it.
    """
    return SharedCreatures(creatures=access.LiveShare(share).names(session))


def _preview_reader(kind: str) -> Callable[..., Response]:
    def read(request: Request, slug: Slug, services: ServicesDep) -> Response:
        with services.sessions.read() as session:
            cover = share(request, slug, session).cover
        found = responses.existing(request, cover, services, kind)
        return found or responses.enqueued(services, cover, kind, anonymous=True)

    return read


for kind, noun in ((PREVIEW, "a picture"), (LOOP, "a looping film")):
    sent = sends(KINDS[kind].media_type, PENDING)
    router.get(
        f"/shares/{{slug}}/{kind}",
        **sent,
        name=f"read_share_{kind.replace('.', '_')}",
        description=f"Return {noun} of the creature, or of the best of the archive; 202 while "
        "it is made.",
        dependencies=[PUBLIC],
    )(_preview_reader(kind))


@router.get("/shares")
def list_shares(
    request: Request,
    session: SessionDep,
    principal: Reader,
    cursor: str | None = None,
    limit: Limit = 50,
) -> SharePage:
    """Return one's own shares, newest first, also revoked and expired ones.

    An admin gets everybody's.
    """
    listed = select(Share)
    if not principal.may(ADMIN):
        listed = listed.where(Share.owner == principal.token)
    return _page(request, session, listed, cursor, limit)


@router.get("/commons", dependencies=[PUBLIC])
def read_commons(
    request: Request, session: SessionDep, cursor: str | None = None, limit: Limit = 50
) -> SharePage:
    """Return the live listed shares, newest first."""
    return _page(request, session, access.live().where(Share.listed), cursor, limit)


def _page(
    request: Request,
    session: Session,
    listed: Select[Share],
    cursor: str | None,
    limit: int,
) -> SharePage:
    shares, following = NEWEST_FIRST.page(session, listed, cursor, limit)
    items = [share_read(request, session, share) for share in shares]
    return SharePage(items=items, next=following)


def own_share(slug: str, principal: Writer, services: ServicesDep) -> str:
    """Return the slug of a path; raise `DomainError` if somebody else owns the share."""
    if access.SLUG.fullmatch(slug):
        authorize_owner(services, principal, Share, slug)
    return slug


OwnSlug = Annotated[str, Depends(own_share)]


@router.delete("/shares/{slug}")
def revoke(slug: OwnSlug, request: Request, services: ServicesDep) -> ShareRead:
    """Revoke a share: its address shows nothing from now on."""
    with services.sessions.write.begin() as session:
        share = access.lock(session, slug)
        if share is None:
            raise NotFound("Nothing is shared under this name.")
        if share.revoked_at is None:
            share.revoked_at = now(session)
        stored = access.archive_file(session, share)
        if stored:
            session.delete(stored)
            discard(session, [stored.path])
        return share_read(request, session, share)


def share_read(request: Request, session: Session, share: Share) -> ShareRead:
    names = [name for name in ShareRead.model_fields if name not in ("url", "run", "state")]
    return ShareRead(
        url=f"{public_address(request)}/s/{share.slug}",
        run=share.run_id,
        state=access.state(session, share),
        **{name: getattr(share, name) for name in names},
    )
