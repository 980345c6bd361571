"""Routes of results: the archive or the table of a run, as columns and as files."""

import csv
import io
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive import export, poses
from microcosmos.sizes import size
from microcosmos.version import VERSION

from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import MAY_READ, MAY_READ_SHARED, ShareAccess, ShareAccessDep
from ..core.answers import respond, tag_of
from ..core.api import Answers, named, sends
from ..core.errors import Invalid, NotFound, invalid_field
from ..runs import deps
from ..runs.deps import RunDep
from ..services.services import ServicesDep, SessionDep
from ..storage import ranges, segments
from ..storage.segments import LARGEST
from ..tables import Artifact, Result, Run
from . import elites, reading
from . import measures as recorded_measures
from .archive_of_request import JSON, ShownArchiveDep, archive_answers, refuse_table
from .schemas import ArchiveRead, CentroidsRead, HistoryRead, ReprojectionRead, ResultsRead

router = APIRouter(prefix="/runs/{run_id}", tags=["archives"])
BINARY = sends("application/octet-stream", {404: {}})
UNCHANGED: Answers = {304: {"description": "Unchanged"}}

# About 10 MB.
POSE_CELLS = 1000


@router.get("/archive", **archive_answers(ArchiveRead), dependencies=[MAY_READ_SHARED])
async def read_archive(
    shown: ShownArchiveDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
    measures: str = "",
    after: Annotated[int | None, Query(ge=0)] = None,
) -> Response:
    """Return the elite of each cell, now or as of a generation.

    `measures` names recorded measures, separated by commas, to return with the elites. With
    `after`, a generation, only the elites that entered later are returned, and only the cells
    that were emptied later.
    """
    of, asked = (shown.services, shown.run, shown.file), (generation, after, _sorted(measures))
    return await shown.answer(lambda session: reading.archive(session, *of, *asked), *asked)


@router.get("/archive/history", **archive_answers(HistoryRead), dependencies=[MAY_READ_SHARED])
async def read_history(shown: ShownArchiveDep, measures: str = "") -> Response:
    """Return every elite that ever entered, and every cell that lost one without a new one.

    Each generation's archive follows from them.
    """
    of, asked = (shown.services, shown.run, shown.file), _sorted(measures)
    return await shown.answer(lambda session: reading.history(session, *of, asked), asked)


@router.get(
    "/archive/reprojection",
    **archive_answers(ReprojectionRead),
    dependencies=[MAY_READ_SHARED],
)
async def read_reprojection(
    shown: ShownArchiveDep, axes: Annotated[str, Query(min_length=1)], measures: str = ""
) -> Response:
    """Return the archive of all creatures that ever entered, over any other axes.

    `axes` are measures, `fitness`, or principal components of all measures (`pc1` to `pc9`),
    separated by commas. An axis of the archive keeps its ends and bins; any other has the
    default ends of its measure and 24 bins. `measures` names further columns to return.
    """
    asked = (axes, _sorted(measures))
    return await shown.answer(
        lambda session: reading.reprojected(session, shown.run, *asked), *asked
    )


def _sorted(measures: str) -> str:
    """Return the names sorted, each once: requests for the same measures have one answer."""
    return ",".join(sorted(set(filter(None, measures.split(",")))))


@router.get("/archive/poses", **BINARY, dependencies=[MAY_READ_SHARED])
def read_poses(
    run: RunDep,
    session: SessionDep,
    cells: Annotated[str, Query(pattern=r"^\d{1,9}(,\d{1,9})*$")],
    generation: Annotated[int | None, Query(ge=0)] = None,
) -> Response:
    """Return the pose streams of the elites of some cells, now or as of a generation.

    `cells` are numbers, separated by commas. The length of each stream precedes it, as a
    little-endian uint32. Elites without a stream are left out.
    """
    refuse_table(run)
    numbers = sorted({int(cell) for cell in cells.split(",")})
    if len(numbers) > POSE_CELLS:
        raise invalid_field("cells", f"at most {POSE_CELLS:,} cells", f"{len(numbers):,}")
    as_of = elites.generation_of(run, generation)
    found = session.scalars(elites.poses(run, as_of, numbers))
    return Response(poses.batch(found), media_type="application/octet-stream")


def _refuse_large(run: Run, file: Artifact) -> None:
    """Raise `DomainError` for a file that is too large to convert."""
    whole = segments.whole(file)
    if whole.size > LARGEST:
        detail = (
            f"The file of run {run.id} has {size(whole.size)}, more than the {size(LARGEST)} "
            f"that the server converts. Download it: /api/v1/runs/{run.id}/archive.h5"
        )
        raise Invalid(detail, title="Run too large")


def _file_of_cvt(run_id: UUID, services: ServicesDep, share: ShareAccessDep) -> Artifact | None:
    """Find the last checkpoint, over a connection that is closed before it is read."""
    with services.sessions.read() as session:
        run = deps.run(run_id, session, share)
        refuse_table(run)
        if recorded_measures.kind(run)[0] != "cvt":
            detail = "The archive has no Voronoi cells, and so no centroids."
            raise NotFound(detail, title="No centroids")
        if file := last_checkpoint(session, run.id):
            _refuse_large(run, file)
        return file


@router.get(
    "/archive/centroids",
    responses={200: {"model": CentroidsRead}, **UNCHANGED},
    dependencies=[MAY_READ_SHARED],
)
async def read_centroids(
    request: Request,
    file: Annotated[Artifact | None, Depends(_file_of_cvt)],
    services: ServicesDep,
) -> Response:
    """Return the centroids of a CVT archive; null before its first checkpoint."""

    def make() -> bytes:
        found = file and export.centroids(segments.read(services.artifacts, file)).tolist()
        return CentroidsRead(centroids=found).model_dump_json().encode()

    tag = tag_of(VERSION, "centroids", file and segments.whole(file).sha256)
    return await respond(request, tag, make, JSON, {})


@router.get("/archive.h5", **BINARY, dependencies=[MAY_READ_SHARED])
def download_archive(
    request: Request, run_id: UUID, share: ShareAccessDep, services: ServicesDep
) -> Response:
    """Return the file of the last checkpoint; it contains the archive or the table."""
    with services.sessions.read() as session:
        run = deps.run(run_id, session, share)
        artifact = _file(session, run, share)
    # Over no connection: the store may be slow.
    return ranges.file(request, services.artifacts, artifact, attachment(run, "h5"))


def _file_with_run(
    run_id: UUID, services: ServicesDep, share: ShareAccessDep
) -> tuple[Run, Artifact]:
    """Find the file of an archive, over a connection that is closed before it is read."""
    with services.sessions.read() as session:
        run = deps.run(run_id, session, share)
        refuse_table(run)
        file = _file(session, run, share)
        _refuse_large(run, file)
        return run, file


@router.get("/archive.csv", **sends("text/csv", UNCHANGED), dependencies=[MAY_READ_SHARED])
async def download_archive_csv(
    request: Request,
    found: Annotated[tuple[Run, Artifact], Depends(_file_with_run)],
    services: ServicesDep,
) -> Response:
    """Return the archive of the last checkpoint in the columns of pyribs."""
    run, file = found

    def make() -> bytes:
        return export.csv(segments.read(services.artifacts, file)).encode()

    tag = tag_of(VERSION, "csv", segments.whole(file).sha256)
    return await respond(request, tag, make, "text/csv", attachment(run, "csv"))


def _file(session: Session, run: Run, share: ShareAccess | None) -> Artifact:
    """Return the file of a share, else the last checkpoint; raise `DomainError` without it."""
    if share:
        if (shared := share.archive(session)) is None:
            detail = (
                f"The share has no file of generation {run.generation}; its elites are shown."
            )
            raise NotFound(detail, title="No file")
        return shared
    artifact = last_checkpoint(session, run.id)
    if artifact is None:
        detail = f"Run {run.id} has no checkpoint yet; it is {run.status}."
        raise NotFound(detail, title="No checkpoint yet")
    return artifact


def attachment(run: Run, ending: str) -> dict[str, str]:
    kind = "archive" if recorded_measures.has_archive(run) else run.experiment
    return named(f"{kind}-{str(run.id)[:8]}.{ending}")


@router.get("/results", dependencies=[MAY_READ])
def read_results(run: RunDep, session: SessionDep) -> ResultsRead:
    """Return all rows so far, in the order in which they were measured."""
    return ResultsRead(generation=run.generation, summary=run.summary, rows=_rows(session, run))


@router.get("/results.csv", **sends("text/csv"), dependencies=[MAY_READ])
def download_results(run: RunDep, session: SessionDep) -> Response:
    """Return the rows as CSV."""
    if recorded_measures.has_archive(run):
        detail = (
            f"A run of `{run.experiment}` has no table; its result is the archive at "
            f"/api/v1/runs/{run.id}/archive."
        )
        raise NotFound(detail, title="No table")
    rows = _rows(session, run)
    if not rows:
        detail = f"Run {run.id} has no results yet; it is {run.status}."
        raise NotFound(detail, title="No results yet")
    columns = list(dict.fromkeys(name for row in rows for name in row if name != "creature"))
    text = io.StringIO()
    writer = csv.DictWriter(text, [*columns, "creature"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return Response(text.getvalue(), headers=attachment(run, "csv"), media_type="text/csv")


def _rows(session: Session, run: Run) -> list[dict[str, Any]]:
    mine = select(Result).where(Result.run_id == run.id).order_by(Result.number)
    return [{**row.values, "creature": row.creature} for row in session.scalars(mine)]
