"""Routes of results: the archive or the table of a run, as columns and as files."""

import csv
import io
import struct
from collections.abc import Callable, Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response
from sqlalchemy import Select, func, select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import MAY_READ, MAY_READ_SHARED, ShareAccessDep
from ..core.api import sends
from ..core.errors import ProblemError, invalid_field
from ..runs.curves import coverage_at
from ..runs.deps import RunDep
from ..services.services import ServicesDep, SessionDep
from ..storage import ranges
from ..tables import Artifact, Elite, Result, Run
from . import elites, learned, reprojection
from . import measures as recorded_measures
from .schemas import (
    ArchiveRead,
    CentroidsRead,
    HistoryRead,
    Measure,
    ReprojectionRead,
    ResultsRead,
)

router = APIRouter(prefix="/runs/{run_id}", tags=["archives"])
BINARY = sends("application/octet-stream", {404: {}})

HISTORY_ENTRIES = 400_000
"""About 50 MB."""
POSE_CELLS = 1000
"""About 10 MB."""
LENGTH = struct.Struct("<I")


@router.get("/archive", dependencies=[MAY_READ_SHARED])
def read_archive(
    run: RunDep,
    session: SessionDep,
    services: ServicesDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
    measures: str = "",
    after: Annotated[int | None, Query(ge=0)] = None,
) -> ArchiveRead:
    """Return the elite of each cell, now or as of a generation.

    `measures` names recorded measures, separated by commas, to return with the elites. With
    `after`, a generation, only the elites that entered later are returned, and only the cells
    that were emptied later.
    """
    _refuse_table(run)
    as_of = run.generation if generation is None else min(generation, run.generation)
    own = learned.read(session, services, run)
    recorded = _recorded(session, run, own)
    names = _requested(measures, recorded)
    known = -1 if after is None else min(after, run.generation)
    kind, cells = recorded_measures.kind(run)
    return ArchiveRead(
        generation=as_of,
        kind=kind,
        cells=cells,
        axes=recorded_measures.axes(run),
        recorded=recorded,
        coverage=coverage_at(session, run.id, as_of),
        **_columns(session, lambda stored: elites.as_of(run, as_of, stored, known), names, own),
        **_emptied(session, elites.emptied(run, as_of, known)),
    )


@router.get("/archive/history", dependencies=[MAY_READ_SHARED])
def read_history(
    run: RunDep, session: SessionDep, services: ServicesDep, measures: str = ""
) -> HistoryRead:
    """Return every elite that ever entered, and every cell that lost one without a new one.

    Each generation's archive follows from them.
    """
    _refuse_table(run)
    own = learned.read(session, services, run)
    names = _requested(measures, _recorded(session, run, own))
    _refuse_long(session, run)

    def ordered(stored: Sequence[str]) -> Select[*tuple[Any, ...]]:
        return elites.all_time(run, stored).order_by(Elite.generation, Elite.cell)

    columns = _columns(session, ordered, names, own)
    columns |= _emptied(session, elites.losses(run))
    return HistoryRead(generation=run.generation, **columns)


@router.get("/archive/reprojection", dependencies=[MAY_READ_SHARED])
def read_reprojection(
    run: RunDep, session: SessionDep, axes: str, measures: str = ""
) -> ReprojectionRead:
    """Return the archive of all creatures that ever entered, over any other axes.

    `axes` are measures, `fitness`, or principal components of all measures (`pc1` to `pc9`),
    separated by commas. An axis of the archive keeps its ends and bins; any other has the
    default ends of its measure and 24 bins. `measures` names further columns to return.
    """
    _refuse_table(run)
    recorded = recorded_measures.recorded(session, run)
    names, more = list(filter(None, axes.split(","))), _requested(measures, recorded)
    _refuse_long(session, run)
    return reprojection.read(session, run, names, more, [one.name for one in recorded])


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
    _refuse_table(run)
    numbers = sorted({int(cell) for cell in cells.split(",")})
    if len(numbers) > POSE_CELLS:
        raise invalid_field("cells", f"at most {POSE_CELLS:,} cells", f"{len(numbers):,}")
    as_of = run.generation if generation is None else min(generation, run.generation)
    found = filter(None, session.scalars(elites.poses(run, as_of, numbers)))
    content = b"".join(LENGTH.pack(len(stream)) + stream for stream in found)
    return Response(content, media_type="application/octet-stream")


@router.get("/archive/centroids", dependencies=[MAY_READ_SHARED])
def read_centroids(run: RunDep, session: SessionDep, services: ServicesDep) -> CentroidsRead:
    """Return the centroids of a CVT archive; null before its first checkpoint."""
    _refuse_table(run)
    if recorded_measures.kind(run)[0] != "cvt":
        detail = "The archive has no Voronoi cells, and so no centroids."
        raise ProblemError(404, "No centroids", detail)
    first = last_checkpoint(session, run.id)
    if first is None:
        return CentroidsRead(centroids=None)
    found = export.centroids(services.artifacts.read(first.path))
    return CentroidsRead(centroids=found.tolist())


def _requested(measures: str, recorded: Sequence[Measure]) -> list[str]:
    names = list(dict.fromkeys(filter(None, measures.split(","))))
    existing = [measure.name for measure in recorded]
    if wrong := [name for name in names if name not in existing]:
        raise invalid_field("measures", f"names among {', '.join(existing)}", ", ".join(wrong))
    return names


def _refuse_long(session: Session, run: Run) -> None:
    counted = select(func.count()).select_from(Elite).where(elites.recorded_in(run))
    entries = session.execute(counted).scalar_one()
    if entries > HISTORY_ENTRIES:
        detail = (
            f"The history of this archive has {entries:,} entries, more than the "
            f"{HISTORY_ENTRIES:,} that one answer holds. Read single generations at "
            f"/api/v1/runs/{run.id}/archive?generation=."
        )
        raise ProblemError(422, "History too long", detail)


def _recorded(session: Session, run: Run, own: learned.LearnedMeasures | None) -> list[Measure]:
    return [*(own.described if own else []), *recorded_measures.recorded(session, run)]


def _columns(
    session: Session,
    select_with: Callable[[Sequence[str]], Select[*tuple[Any, ...]]],
    names: Sequence[str],
    own: learned.LearnedMeasures | None,
) -> dict[str, Any]:
    """Return the wire's columns; `select_with` selects elites with stored measures."""
    stored, first = learned.stored(names, own), len(elites.COLUMNS)
    found = session.execute(select_with(stored)).all()
    values = {name: [elite[first + i] for elite in found] for i, name in enumerate(stored)}
    if own and set(names) & set(own.names):
        values |= own.columns(values)
    return {
        "cell": [elite.cell for elite in found],
        "fitness": [elite.fitness for elite in found],
        "descriptors": [elite.descriptors for elite in found],
        "elite_generation": [elite.generation for elite in found],
        "creature": [elite.creature for elite in found],
        "trusted": [elite.trusted for elite in found],
        "measures": {name: values[name] for name in names},
    }


def _emptied(session: Session, found: Select[int, int]) -> dict[str, Any]:
    rows = session.execute(found).all()
    cells, generations = [row.cell for row in rows], [row.generation for row in rows]
    return {"emptied": cells, "emptied_generation": generations}


def _refuse_table(run: Run) -> None:
    if not recorded_measures.has_archive(run):
        detail = (
            f"A run of `{run.experiment}` has no archive; its result is the table at "
            f"/api/v1/runs/{run.id}/results."
        )
        raise ProblemError(404, "No archive", detail)


@router.get("/archive.h5", **BINARY, dependencies=[MAY_READ_SHARED])
def download_archive(
    request: Request,
    run: RunDep,
    share: ShareAccessDep,
    session: SessionDep,
    services: ServicesDep,
) -> Response:
    """Return the file of the last checkpoint; it contains the archive or the table."""
    artifact = share.archive(session) if share else _checkpoint(session, run)
    headers = {**attachment(run, "h5"), "Cache-Control": "no-cache"}
    return ranges.file(request, services.artifacts, artifact, headers)


@router.get("/archive.csv", **sends("text/csv"), dependencies=[MAY_READ_SHARED])
def download_archive_csv(
    run: RunDep, share: ShareAccessDep, session: SessionDep, services: ServicesDep
) -> Response:
    """Return the archive of the last checkpoint in the columns of pyribs."""
    _refuse_table(run)
    artifact = share.archive(session) if share else _checkpoint(session, run)
    text = export.csv(services.artifacts.read(artifact.path))
    return Response(text, headers=attachment(run, "csv"), media_type="text/csv")


def _checkpoint(session: Session, run: Run) -> Artifact:
    artifact = last_checkpoint(session, run.id)
    if artifact is None:
        detail = f"Run {run.id} has no checkpoint yet; it is {run.status}."
        raise ProblemError(404, "No checkpoint yet", detail)
    return artifact


def attachment(run: Run, ending: str) -> dict[str, str]:
    kind = "archive" if recorded_measures.has_archive(run) else run.experiment
    name = f"{kind}-{str(run.id)[:8]}.{ending}"
    return {"Content-Disposition": f'attachment; filename="{name}"'}


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
        raise ProblemError(404, "No table", detail)
    rows = _rows(session, run)
    if not rows:
        detail = f"Run {run.id} has no results yet; it is {run.status}."
        raise ProblemError(404, "No results yet", detail)
    columns = list(dict.fromkeys(name for row in rows for name in row if name != "creature"))
    text = io.StringIO()
    writer = csv.DictWriter(text, [*columns, "creature"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return Response(text.getvalue(), headers=attachment(run, "csv"), media_type="text/csv")


def _rows(session: Session, run: Run) -> list[dict[str, Any]]:
    mine = select(Result).where(Result.run_id == run.id).order_by(Result.number)
    return [{**row.values, "creature": row.creature} for row in session.scalars(mine)]
