"""Publishing: what may be seen by whoever has an address, and taking it back."""

import logging
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from redis import RedisError
from sqlalchemy import Select, and_, or_, select
from sqlalchemy.orm import Session

from ..auth.authorize import PUBLIC, Reader, Writer, authorize_owner
from ..auth.principal import ADMIN
from ..core.database import clock
from ..core.errors import ProblemError
from ..core.uploads import json_route
from ..creatures.schemas import Rendering
from ..renderings import reading
from ..renderings import storage as renderings
from ..services.deps import ServicesDep, SessionDep
from ..services.services import Services
from ..tables import PREVIEW, Creature, Share
from . import archive_files, publishing
from .schemas import ShareAsked, SharePage, ShareRead

log = logging.getLogger(__name__)
ASKED_BYTES = 1 << 16

router = APIRouter(tags=["shares"], route_class=json_route(ASKED_BYTES))


@router.post(
    "/shares",
    status_code=201,
    responses={200: {"model": ShareRead}},
)
def publish(
    principal: Writer,
    sent: ShareAsked,
    request: Request,
    services: ServicesDep,
    response: Response,
) -> ShareRead:
    """Publish a creature or an archive. What is live already is answered again, with 200."""
    with services.sessions.write.begin() as session:
        share, new = publishing.publish(session, sent, principal)
        read = told(request, session, share)
    if share.run_id:
        archive_files.keep(services, share)
    _prepare(services, share.cover)
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/v1/shares/{share.slug}"
    return read


def _prepare(services: Services, cover: str) -> None:
    """Have picture and replay made, so that they are there when the first stranger comes."""
    try:
        with services.sessions.read() as session:
            if renderings.find(session, cover, PREVIEW) is None:
                renderings.order(services, cover, PREVIEW)
    except (RedisError, renderings.RenderingFailed) as error:
        log.warning("The preview of %s is left to who wants to see it: %s", cover, error)


Slug = Annotated[str, Path(pattern=f"^{publishing.SLUG.pattern}$")]


def share(
    request: Request,
    slug: Slug,
    session: SessionDep,
) -> Share:
    found = publishing.opened(session, slug)
    request.state.listed = found.listed
    return found


ShareDep = Annotated[Share, Depends(share)]
PNG: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/png": {}}},
    202: {"model": Rendering},
}


@router.get("/shares/{slug}", dependencies=[PUBLIC])
def read_share(request: Request, share: ShareDep, session: SessionDep) -> ShareRead:
    return told(request, session, share)


@router.get(
    "/shares/{slug}/preview.png",
    response_class=Response,
    responses=PNG,
    dependencies=[PUBLIC],
)
def read_preview(
    request: Request, share: ShareDep, session: SessionDep, services: ServicesDep
) -> Response:
    """Return a picture of the creature, or of the best of the archive; 202 while it is made."""
    cover = session.get_one(Creature, share.cover)
    there = reading.kept(request, cover, session, services, PREVIEW)
    return there or reading.ordered(services, share.cover, PREVIEW, anonymous=True)


Limit = Annotated[int, Query(ge=1, le=200)]


@router.get("/shares")
def list_shares(
    request: Request,
    session: SessionDep,
    principal: Reader,
    cursor: str | None = None,
    limit: Limit = 50,
) -> SharePage:
    """One's own shares, newest first, with those that were taken back or have expired.

    An admin sees everybody's: who knows an address sees what was shared.
    """
    mine = select(Share).where(Share.owner == principal.token)
    everybody = principal.may(ADMIN)
    return _page(request, session, select(Share) if everybody else mine, cursor, limit)


@router.get("/commons", dependencies=[PUBLIC])
def read_commons(
    request: Request, session: SessionDep, cursor: str | None = None, limit: Limit = 50
) -> SharePage:
    """What is published for everybody to find, newest first."""
    return _page(request, session, publishing.live().where(Share.listed), cursor, limit)


def own_share(slug: str, principal: Writer, services: ServicesDep) -> str:
    """Return the slug of a path; raise `ProblemError` if somebody else owns the share."""
    if publishing.SLUG.fullmatch(slug):
        authorize_owner(services, principal, Share, slug)
    return slug


OwnSlug = Annotated[str, Depends(own_share)]


@router.delete("/shares/{slug}")
def revoke(slug: OwnSlug, request: Request, services: ServicesDep) -> ShareRead:
    """Take it back: from now on its address shows nothing."""
    with services.sessions.write.begin() as session:
        share = publishing.find(session, slug)
        if share is None:
            raise ProblemError(404, "Not found", "Nothing is shared under this name.")
        if share.revoked_at is None:
            share.revoked_at = session.execute(select(clock())).scalar_one()
        stored = archive_files.forget(session, share)
        read = told(request, session, share)
    if stored:
        services.artifacts.delete(stored)
    return read


def told(request: Request, session: Session, share: Share) -> ShareRead:
    names = [name for name in ShareRead.model_fields if name not in ("url", "run", "state")]
    return ShareRead(
        url=f"{base(request)}/s/{share.slug}",
        run=share.run_id,
        state=publishing.state(session, share),
        **{name: getattr(share, name) for name in names},
    )


def base(request: Request) -> str:
    """How the outside reaches this server, without a slash at the end."""
    given = request.app.state.services.settings.public_url
    return (given or str(request.base_url)).rstrip("/")


def _page(
    request: Request,
    session: Session,
    statement: Select[Share],
    cursor: str | None,
    limit: int,
) -> SharePage:
    """A cursor is the name of the last share that was seen."""
    if cursor is not None:
        statement = statement.where(_after(session, cursor))
    ordered = statement.order_by(Share.created_at.desc(), Share.slug.desc())
    found = list(session.scalars(ordered.limit(limit + 1)))
    items = [told(request, session, share) for share in found[:limit]]
    return SharePage(items=items, next=items[-1].slug if len(found) > limit else None)


def _after(session: Session, cursor: str) -> Any:
    last = publishing.find(session, cursor)
    if last is None:
        detail = f"`cursor` must be the `next` of an earlier answer; got {cursor!r:.80}."
        raise ProblemError(422, "Invalid input", detail)
    at_once = and_(Share.created_at == last.created_at, Share.slug < last.slug)
    return or_(Share.created_at < last.created_at, at_once)
