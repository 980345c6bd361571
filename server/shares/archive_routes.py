"""What strangers may read of a run through a share: its archive as it was, and nothing else."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response

from microcosmos.archive import export

from ..archives import routes as archives
from ..archives.schemas import ArchiveRead, CentroidsRead, HistoryRead
from ..auth.authorize import PUBLIC
from ..core.errors import ProblemError
from ..runs import detail_routes
from ..runs.overview import read_run
from ..runs.schemas import Curves, RunRead
from ..services.deps import ServicesDep, SessionDep
from ..storage import ranges
from ..tables import Artifact, Run, Share
from . import archive_files, publishing
from .creature_routes import ShareDep

router = APIRouter(prefix="/shares/{slug}", tags=["shares"])


def shared_run(share: ShareDep, run_id: str, session: SessionDep) -> Run:
    if share.run_id is None or run_id != str(share.run_id):
        raise ProblemError(404, "Not found", f"This share holds no run of the id {run_id:.64}.")
    return publishing.frozen(session, share)


RunDep = Annotated[Run, Depends(shared_run)]


@router.get("/runs/{run_id}", dependencies=[PUBLIC])
def read_shared_run(run: RunDep, services: ServicesDep, session: SessionDep) -> RunRead:
    """The run as it was, without its owner's notes."""
    return read_run(services, session, run)


@router.get("/runs/{run_id}/generations", dependencies=[PUBLIC])
def read_shared_generations(
    run: RunDep,
    session: SessionDep,
    points: Annotated[int | None, Query(ge=2, le=10_000)] = None,
) -> Curves:
    return detail_routes.read_generations(run, session, points)


@router.get("/runs/{run_id}/archive", dependencies=[PUBLIC])
def read_shared_archive(
    run: RunDep,
    session: SessionDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
    measures: str = "",
) -> ArchiveRead:
    return archives.read_archive(run, session, generation, measures)


@router.get("/runs/{run_id}/archive/history", dependencies=[PUBLIC])
def read_shared_history(run: RunDep, session: SessionDep, measures: str = "") -> HistoryRead:
    return archives.read_history(run, session, measures)


@router.get("/runs/{run_id}/archive/centroids", dependencies=[PUBLIC])
def read_shared_centroids(
    run: RunDep, session: SessionDep, services: ServicesDep
) -> CentroidsRead:
    return archives.read_centroids(run, session, services)


@router.get("/runs/{run_id}/archive.h5", response_class=Response, dependencies=[PUBLIC])
def download_shared_archive(
    request: Request, share: ShareDep, run: RunDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The archive's file as it was, with licence and credit."""
    headers = archives.attachment(run, "h5")
    return ranges.file(request, services.artifacts, _file(session, share), headers)


@router.get("/runs/{run_id}/archive.csv", response_class=Response, dependencies=[PUBLIC])
def download_shared_table(
    share: ShareDep, run: RunDep, session: SessionDep, services: ServicesDep
) -> Response:
    table = export.csv(services.artifacts.read(_file(session, share).path))
    return Response(table, headers=archives.attachment(run, "csv"), media_type="text/csv")


def _file(session: SessionDep, share: Share) -> Artifact:
    found = archive_files.find(session, share)
    if found is None:
        detail = f"No file was kept of generation {share.generation}; its elites are here."
        raise ProblemError(404, "No file", detail)
    return found
