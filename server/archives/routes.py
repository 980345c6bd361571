"""The archive of a run: as columns, now or as it was, and as files."""

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import MAY_READ_SHARED
from ..auth.capability import SharedViewDep
from ..core.errors import ProblemError
from ..runs.deps import RunDep
from ..services.deps import ServicesDep, SessionDep
from ..storage import ranges
from ..tables import Artifact, Elite, Run
from . import elites
from . import measures as of_elites
from .schemas import ArchiveRead, CentroidsRead, HistoryRead, Measure

router = APIRouter(prefix="/runs/{run_id}", tags=["archives"])
binary: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {}}},
    404: {},
}

HISTORY_ENTRIES = 400_000
"""About 50 MB."""


@router.get("/archive", dependencies=[MAY_READ_SHARED])
def read_archive(
    run: RunDep,
    session: SessionDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
    measures: str = "",
    after: Annotated[int | None, Query(ge=0)] = None,
) -> ArchiveRead:
    """The elite of each cell, now or as of a generation.

    With `measures`, names with commas between them, what was recorded of the elites under
    those names too: an archive can be looked at along any of them. With `after`, a generation,
    only the elites that entered later, for who knows the others.
    """
    _refuse_without(run)
    as_of = run.generation if generation is None else min(generation, run.generation)
    recorded = of_elites.recorded(session, run)
    names = _asked(measures, recorded)
    known = -1 if after is None else min(after, run.generation)
    kind, cells = of_elites.kind(run)
    return ArchiveRead(
        generation=as_of,
        kind=kind,
        cells=cells,
        axes=of_elites.axes(run),
        recorded=recorded,
        **_columns(session.execute(elites.at(run, as_of, names, known)).all(), names),
    )


@router.get("/archive/history", dependencies=[MAY_READ_SHARED])
def read_history(run: RunDep, session: SessionDep, measures: str = "") -> HistoryRead:
    """Every elite that ever entered: the archive of each generation can be told from it."""
    _refuse_without(run)
    names = _asked(measures, of_elites.recorded(session, run))
    _refuse_too_long(session, run)
    ordered = elites.ever(run, names).order_by(Elite.generation, Elite.cell)
    columns = _columns(session.execute(ordered).all(), names)
    return HistoryRead(generation=run.generation, **columns)


@router.get("/archive/centroids", dependencies=[MAY_READ_SHARED])
def read_centroids(run: RunDep, session: SessionDep, services: ServicesDep) -> CentroidsRead:
    """The cells of a CVT archive; null until its first checkpoint is there."""
    _refuse_without(run)
    if of_elites.kind(run)[0] != "cvt":
        detail = "The cells of this archive are a grid's: its axes say where they are."
        raise ProblemError(404, "No centroids", detail)
    first = last_checkpoint(session, run.id)
    if first is None:
        return CentroidsRead(centroids=None)
    found = export.centroids(services.artifacts.read(first.path))
    return CentroidsRead(centroids=found.tolist())


def _refuse_too_long(session: Session, run: Run) -> None:
    """A history is sent whole, and has to find room in a page."""
    mine = select(func.count()).select_from(Elite).where(elites.until_now(run))
    entries = session.execute(mine).scalar_one()
    if entries > HISTORY_ENTRIES:
        detail = (
            f"The history of this archive has {entries:,} entries, of which at most "
            f"{HISTORY_ENTRIES:,} are sent at once; single generations are at "
            f"/api/v1/runs/{run.id}/archive?generation=."
        )
        raise ProblemError(422, "Too long a history", detail)


def _asked(measures: str, recorded: Sequence[Measure]) -> list[str]:
    """Names of measures with commas between them; `ProblemError` where one was not recorded."""
    names = list(dict.fromkeys(filter(None, measures.split(","))))
    of_elites.refuse_unknown(names, recorded)
    return names


def _columns(found: Sequence[Any], names: Sequence[str]) -> dict[str, Any]:
    first = len(elites.COLUMNS)
    return {
        "cell": [elite.cell for elite in found],
        "fitness": [elite.fitness for elite in found],
        "descriptors": [elite.descriptors for elite in found],
        "elite_generation": [elite.generation for elite in found],
        "creature": [elite.creature for elite in found],
        "measures": {
            name: [elite[first + i] for elite in found] for i, name in enumerate(names)
        },
    }


def _refuse_without(run: Run) -> None:
    if not of_elites.searched(run):
        detail = (
            f"A run of `{run.experiment}` fills no archive; its result is at "
            f"/api/v1/runs/{run.id}/results."
        )
        raise ProblemError(404, "No archive", detail)


@router.get(
    "/archive.h5", response_class=Response, responses=binary, dependencies=[MAY_READ_SHARED]
)
def download_archive(
    request: Request,
    run: RunDep,
    share: SharedViewDep,
    session: SessionDep,
    services: ServicesDep,
) -> Response:
    """The last checkpoint's file; of a run without an archive it holds the table."""
    artifact = share.archive(session) if share else _checkpoint(session, run)
    headers = {**attachment(run, "h5"), "Cache-Control": "no-cache"}
    return ranges.file(request, services.artifacts, artifact, headers)


@router.get(
    "/archive.csv",
    response_class=Response,
    responses={200: {"content": {"text/csv": {}}}},
    dependencies=[MAY_READ_SHARED],
)
def download_table(
    run: RunDep, share: SharedViewDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The last checkpoint's archive in the columns of pyribs."""
    _refuse_without(run)
    artifact = share.archive(session) if share else _checkpoint(session, run)
    table = export.csv(services.artifacts.read(artifact.path))
    return Response(table, headers=attachment(run, "csv"), media_type="text/csv")


def _checkpoint(session: Session, run: Run) -> Artifact:
    artifact = last_checkpoint(session, run.id)
    if artifact is None:
        detail = f"Run {run.id} has no checkpoint yet; it is {run.status}."
        raise ProblemError(404, "No checkpoint yet", detail)
    return artifact


def attachment(run: Run, ending: str) -> dict[str, str]:
    kind = "archive" if of_elites.searched(run) else run.experiment
    name = f"{kind}-{str(run.id)[:8]}.{ending}"
    return {"Content-Disposition": f'attachment; filename="{name}"'}
