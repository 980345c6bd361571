"""Routes of shares: publish, read, list, revoke."""

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request, Response
from pydantic import StringConstraints
from sqlalchemy import Select, select
from sqlalchemy.orm import Session

from ..auth.authorize import PUBLIC, Reader, Writer, authorize_owner
from ..auth.principal import ADMIN
from ..core.api import Answers, sends
from ..core.database import now
from ..core.errors import ProblemError
from ..core.json_body import json_route
from ..core.paging import MOMENT, Order
from ..creatures import storage as creatures
from ..creatures.deps import find_creature
from ..renderings import responses
from ..renderings.schemas import Rendering
from ..services.services import ServicesDep, SessionDep
from ..storage.garbage import discard
from ..tables import LOOP, PREVIEW, Share
from . import access, archive_files, previews, publishing
from .page import public_address
from .schemas import Digest, ShareCreate, SharedCreatures, SharePage, ShareRead

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
        share, new = publishing.publish(session, sent, principal)
        read = share_read(request, session, share)
    if share.run_id:
        archive_files.copy_checkpoint(services, share)
    with services.sessions.read() as session:
        previews.order(services, session, share.cover)
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
    """Return the file of a creature, with its ancestors unless told otherwise, for import; of
    an archive the best.

    Pages of other installations may read it.
    """
    live, name = access.LiveShare(share), creature or share.cover
    live.refuse_unless_holds(session, name)
    row = find_creature(session, name)
    file = creatures.with_ancestors(session, row) if ancestors else creatures.document(row)
    return live.licensed(file)


@router.get("/shares/{slug}/creatures.json", dependencies=[PUBLIC])
def read_shared_creatures(share: ShareDep, session: SessionDep) -> SharedCreatures:
    """Return the names of a share's creatures, for import: of an archive its elites, the best
    first.

    Pages of other installations may read it.
    """
    return SharedCreatures(creatures=access.LiveShare(share).names(session))


def _preview_reader(kind: str, noun: str) -> Callable[..., Response]:
    def read(
        request: Request, share: ShareDep, session: SessionDep, services: ServicesDep
    ) -> Response:
        cover = find_creature(session, share.cover)
        found = responses.existing(request, cover, session, services, kind)
        return found or responses.enqueued(services, share.cover, kind, anonymous=True)

    read.__name__ = f"read_share_{kind.replace('.', '_')}"
    read.__doc__ = (
        f"Return {noun} of the creature, or of the best of the archive; 202 while it is made."
    )
    return read


for kind, noun in ((PREVIEW, "a picture"), (LOOP, "a looping film")):
    sent = sends(responses.MEDIA_TYPES[kind], PENDING)
    router.get(f"/shares/{{slug}}/{kind}", **sent, dependencies=[PUBLIC])(
        _preview_reader(kind, noun)
    )


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
    """Return the slug of a path; raise `ProblemError` if somebody else owns the share."""
    if access.SLUG.fullmatch(slug):
        authorize_owner(services, principal, Share, slug)
    return slug


OwnSlug = Annotated[str, Depends(own_share)]


@router.delete("/shares/{slug}")
def revoke(slug: OwnSlug, request: Request, services: ServicesDep) -> ShareRead:
    """Revoke a share: its address shows nothing from now on."""
    with services.sessions.write.begin() as session:
        share = access.find(session, slug)
        if share is None:
            raise ProblemError(404, "Not found", "Nothing is shared under this name.")
        if share.revoked_at is None:
            share.revoked_at = now(session)
        stored = archive_files.find(session, share)
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
