"""What strangers may read through a share: exactly what was shared, and nothing else."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request
from fastapi.responses import JSONResponse, Response

from microcosmos.archive import creature, creature_h5, export, kin

from .. import creatures, networks, published, ranges, shares
from ..deps import ServicesDep, SessionDep, Sha
from ..deps import creature as named_creature
from ..models import (
    GIF,
    MEASUREMENT,
    MP4,
    PREVIEW,
    REPLAY,
    STRIP,
    Artifact,
    Creature,
    Run,
    Share,
)
from ..problems import Refused
from ..progress import read_run
from ..schemas import (
    Ancestors,
    ArchiveRead,
    CentroidsRead,
    Curves,
    HistoryRead,
    Rendering,
    RunRead,
    ShareRead,
)
from . import archives, generations
from . import creatures as of_creatures
from . import renderings as of_creature
from .shares import told

router = APIRouter(prefix="/shares/{slug}", tags=["shares"])


def share(
    request: Request,
    slug: Annotated[str, Path(pattern="^[A-Za-z0-9_-]{1,43}$")],
    session: SessionDep,
) -> Share:
    found = shares.opened(session, slug)
    request.state.listed = found.listed
    return found


ShareDep = Annotated[Share, Depends(share)]


def shared_creature(share: ShareDep, sha: Sha, session: SessionDep) -> Creature:
    if not shares.holds(session, share, sha):
        raise Refused(404, "Not found", f"This share holds no creature of the name {sha}.")
    return named_creature(sha, session)


def shared_run(share: ShareDep, run_id: str, session: SessionDep) -> Run:
    if share.run_id is None or run_id != str(share.run_id):
        raise Refused(404, "Not found", f"This share holds no run of the id {run_id:.64}.")
    return shares.frozen(session, share)


CreatureDep = Annotated[Creature, Depends(shared_creature)]
RunDep = Annotated[Run, Depends(shared_run)]
PNG: dict[int | str, dict[str, Any]] = {
    200: {"content": {"image/png": {}}},
    202: {"model": Rendering},
}


@router.get("")
def read_share(request: Request, share: ShareDep, session: SessionDep) -> ShareRead:
    return told(request, session, share)


@router.get("/preview.png", response_class=Response, responses=PNG)
def read_preview(
    request: Request, share: ShareDep, session: SessionDep, services: ServicesDep
) -> Response:
    """A picture of the creature, or of the archive's best; 202 while it is made."""
    cover = session.get_one(Creature, share.cover)
    there = of_creature.kept(request, cover, session, services, PREVIEW)
    return there or of_creature.ordered(services, share.cover, PREVIEW, patient=True)


@router.get("/creatures/{sha}", responses={200: {"model": dict[str, Any]}})
def read_shared_creature(
    share: ShareDep,
    row: CreatureDep,
    session: SessionDep,
    download: bool = False,
    ancestors: bool = False,
) -> Response:
    """The creature file under the share's licence; with `ancestors` theirs come along."""
    file = shares.licensed(share, creatures.document(row))
    if ancestors:
        file = kin.document(file, creatures.with_ancestors(session, row)["ancestors"])
    return JSONResponse(file, headers=of_creatures.named(row) if download else None)


@router.get("/creatures/{sha}/creature.h5", response_class=Response)
def read_shared_h5(share: ShareDep, row: CreatureDep) -> Response:
    file = creature.parse(shares.licensed(share, creatures.document(row)))
    name = f'attachment; filename="creature-{row.sha256[:12]}.h5"'
    headers = {"Content-Disposition": name}
    return Response(creature_h5.dump(file), headers=headers, media_type=of_creatures.H5)


@router.get("/creatures/{sha}/ancestors")
def read_shared_ancestors(
    row: CreatureDep, session: SessionDep, depth: Annotated[int, Query(ge=1, le=32)] = 3
) -> Ancestors:
    """Ancestry travels with a share: names, and what is known of those that were kept."""
    return of_creatures.read_ancestors(row, session, depth)


@router.get("/creatures/{sha}/network.{form}", response_class=Response)
def read_shared_network(row: CreatureDep, form: str) -> Response:
    if form not in networks.FORMS:
        known = ", ".join(networks.FORMS)
        raise Refused(404, "Not found", f"A network is written as {known}; got {form!r:.20}.")
    return of_networks(row, form)


def of_networks(row: Creature, form: str) -> Response:
    media_type, _ = networks.FORMS[form]
    headers = {
        "Content-Disposition": f'inline; filename="network-{row.sha256[:12]}.{form}"',
        "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
    }
    return Response(networks.written(row, form), headers=headers, media_type=media_type)


@router.get("/creatures/{sha}/replay", response_class=Response)
def read_shared_replay(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The replay, or 202 while it is made, behind what others wait for."""
    there = of_creature.kept(request, row, session, services, REPLAY)
    return there or of_creature.ordered(services, row.sha256, REPLAY, patient=True)


@router.get("/creatures/{sha}/motion", response_class=Response)
def read_shared_motion(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    there = of_creature.kept_motion(request, row, session, services)
    return there or of_creature.ordered(services, row.sha256, REPLAY, patient=True)


KEPT = (STRIP, GIF, MP4, MEASUREMENT)
"""What strangers see where it was made, and cannot have made."""


@router.get("/creatures/{sha}/{kind}", response_class=Response)
def read_shared_rendering(
    request: Request, row: CreatureDep, kind: str, session: SessionDep, services: ServicesDep
) -> Response:
    """A film, a picture or a measurement that its owner has had made."""
    there = of_creature.kept(request, row, session, services, kind) if kind in KEPT else None
    if there is None and kind == MEASUREMENT:
        return Response(status_code=204)  # As where it was not shared.
    if there is None:
        raise Refused(404, "Not found", f"Nothing was made of it as {kind!r:.20}.")
    return there


@router.get("/runs/{run_id}")
def read_shared_run(run: RunDep, services: ServicesDep, session: SessionDep) -> RunRead:
    """The run as it was, without its owner's notes."""
    return read_run(services, session, run)


@router.get("/runs/{run_id}/generations")
def read_shared_generations(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int | None, Query(ge=2, le=10_000)] = None,
) -> Curves:
    return generations.read_generations(run, session, points)


@router.get("/runs/{run_id}/archive")
def read_shared_archive(
    run: RunDep,
    session: SessionDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
    features: str = "",
) -> ArchiveRead:
    return archives.read_archive(run, session, generation, features)


@router.get("/runs/{run_id}/archive/history")
def read_shared_history(run: RunDep, session: SessionDep, features: str = "") -> HistoryRead:
    return archives.read_history(run, session, features)


@router.get("/runs/{run_id}/archive/centroids")
def read_shared_centroids(
    run: RunDep, session: SessionDep, services: ServicesDep
) -> CentroidsRead:
    return archives.read_centroids(run, session, services)


@router.get("/runs/{run_id}/archive.h5", response_class=Response)
def download_shared_archive(
    request: Request, share: ShareDep, run: RunDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The archive's file as it was, with licence and credit."""
    headers = archives.attachment(run, "h5")
    return ranges.file(request, services.artifacts, _file(session, share), headers)


@router.get("/runs/{run_id}/archive.csv", response_class=Response)
def download_shared_table(
    share: ShareDep, run: RunDep, session: SessionDep, services: ServicesDep
) -> Response:
    table = export.csv(services.artifacts.read(_file(session, share).path))
    return Response(table, headers=archives.attachment(run, "csv"), media_type="text/csv")


def _file(session: SessionDep, share: Share) -> Artifact:
    found = published.find(session, share)
    if found is None:
        detail = f"No file was kept of generation {share.generation}; its elites are here."
        raise Refused(404, "No file", detail)
    return found
