"""What strangers may read of creatures through a share: those it holds, and nothing else."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request
from fastapi.responses import JSONResponse, Response

from microcosmos.archive import creature, creature_h5, pedigree

from ..auth.authorize import PUBLIC
from ..core.errors import ProblemError
from ..creatures import networks
from ..creatures import routes as of_creatures
from ..creatures import storage as creatures
from ..creatures.deps import Sha
from ..creatures.deps import creature as named_creature
from ..creatures.sandbox import sandbox
from ..creatures.schemas import Ancestors, Rendering
from ..renderings import routes as of_creature
from ..services.deps import ServicesDep, SessionDep
from ..tables import GIF, MEASUREMENT, MP4, PREVIEW, REPLAY, STRIP, Creature, Share
from . import publishing
from .routes import told
from .schemas import ShareRead

router = APIRouter(prefix="/shares/{slug}", tags=["shares"])


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


def shared_creature(share: ShareDep, sha: Sha, session: SessionDep) -> Creature:
    if not publishing.holds(session, share, sha):
        raise ProblemError(404, "Not found", f"This share holds no creature of the name {sha}.")
    return named_creature(sha, session)


CreatureDep = Annotated[Creature, Depends(shared_creature)]
PNG: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/png": {}}},
    202: {"model": Rendering},
}


@router.get("", dependencies=[PUBLIC])
def read_share(request: Request, share: ShareDep, session: SessionDep) -> ShareRead:
    return told(request, session, share)


@router.get("/preview.png", response_class=Response, responses=PNG, dependencies=[PUBLIC])
def read_preview(
    request: Request, share: ShareDep, session: SessionDep, services: ServicesDep
) -> Response:
    """A picture of the creature, or of the archive's best; 202 while it is made."""
    cover = session.get_one(Creature, share.cover)
    there = of_creature.kept(request, cover, session, services, PREVIEW)
    return there or of_creature.ordered(services, share.cover, PREVIEW, patient=True)


@router.get(
    "/creatures/{sha}", responses={200: {"model": dict[str, Any]}}, dependencies=[PUBLIC]
)
def read_shared_creature(
    share: ShareDep,
    row: CreatureDep,
    session: SessionDep,
    download: bool = False,
    ancestors: bool = False,
) -> Response:
    """The creature file under the share's licence; with `ancestors` theirs come along."""
    file = publishing.licensed(share, creatures.document(row))
    if ancestors:
        file = pedigree.document(file, creatures.with_ancestors(session, row)["ancestors"])
    return JSONResponse(file, headers=of_creatures.named(row) if download else None)


@router.get("/creatures/{sha}/creature.h5", response_class=Response, dependencies=[PUBLIC])
def read_shared_h5(share: ShareDep, row: CreatureDep) -> Response:
    file = creature.parse(publishing.licensed(share, creatures.document(row)))
    name = f'attachment; filename="creature-{row.sha256[:12]}.h5"'
    headers = {"Content-Disposition": name}
    return Response(creature_h5.dump(file), headers=headers, media_type=of_creatures.H5)


@router.get("/creatures/{sha}/ancestors", dependencies=[PUBLIC])
def read_shared_ancestors(
    row: CreatureDep, session: SessionDep, depth: Annotated[int, Query(ge=1, le=32)] = 3
) -> Ancestors:
    """Ancestry travels with a share: names, and what is known of those that were kept."""
    return of_creatures.read_ancestors(row, session, depth)


@router.get("/creatures/{sha}/network.{form}", response_class=Response, dependencies=[PUBLIC])
def read_shared_network(
    request: Request, slug: Slug, sha: Sha, form: str, services: ServicesDep
) -> Response:
    if form not in networks.FORMS:
        known = ", ".join(networks.FORMS)
        detail = f"A network is written as {known}; got {form!r:.20}."
        raise ProblemError(404, "Not found", detail)
    with services.sessions.read() as session:  # Closed before the network is written.
        row = shared_creature(share(request, slug, session), sha, session)
    headers = {
        "Content-Disposition": f'inline; filename="network-{row.sha256[:12]}.{form}"',
        "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
    }
    data = sandbox().network(row.identity, form)
    return Response(data, headers=headers, media_type=networks.FORMS[form][0])


@router.get("/creatures/{sha}/replay", response_class=Response, dependencies=[PUBLIC])
def read_shared_replay(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The replay, or 202 while it is made, behind what others wait for."""
    there = of_creature.kept(request, row, session, services, REPLAY)
    return there or of_creature.ordered(services, row.sha256, REPLAY, patient=True)


@router.get("/creatures/{sha}/motion", response_class=Response, dependencies=[PUBLIC])
def read_shared_motion(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    there = of_creature.kept_motion(request, row, session, services)
    return there or of_creature.ordered(services, row.sha256, REPLAY, patient=True)


KEPT = (STRIP, GIF, MP4, MEASUREMENT)
"""What strangers see where it was made, and cannot have made."""


@router.get("/creatures/{sha}/{kind}", response_class=Response, dependencies=[PUBLIC])
def read_shared_rendering(
    request: Request, row: CreatureDep, kind: str, session: SessionDep, services: ServicesDep
) -> Response:
    """A film, a picture or a measurement that its owner has had made."""
    there = of_creature.kept(request, row, session, services, kind) if kind in KEPT else None
    if there is None and kind == MEASUREMENT:
        return Response(status_code=204)  # As where it was not shared.
    if there is None:
        raise ProblemError(404, "Not found", f"Nothing was made of it as {kind!r:.20}.")
    return there
