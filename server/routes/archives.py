"""The archive of a run: as columns, now or as it was, and as files."""

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from microcosmos.archive import export

from .. import ranges
from ..checkpoints import last_checkpoint
from ..deps import RunDep, ServicesDep, SessionDep
from ..models import Artifact, Elite, Run
from ..problems import Refused
from ..schemas import ArchiveRead, Axis

router = APIRouter(prefix="/runs/{run_id}", tags=["archives"])
binary: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {}}},
    404: {},
}

COLUMNS = (
    Elite.cell,
    Elite.generation,
    Elite.fitness,
    Elite.descriptors,
    Elite.creature,
)


@router.get("/archive")
def read_archive(
    run: RunDep,
    session: SessionDep,
    generation: Annotated[int | None, Query(ge=0)] = None,
) -> ArchiveRead:
    """The elite of each cell, now or as of a generation."""
    _refuse_without(run)
    as_of = run.generation if generation is None else min(generation, run.generation)
    elites = _elites(session, run, as_of)
    return ArchiveRead(
        generation=as_of,
        axes=[Axis(**axis) for axis in run.spec["archive"]["descriptors"]],
        cell=[elite.cell for elite in elites],
        fitness=[elite.fitness for elite in elites],
        descriptors=[elite.descriptors for elite in elites],
        elite_generation=[elite.generation for elite in elites],
        creature=[elite.creature for elite in elites],
    )


def _refuse_without(run: Run) -> None:
    if "archive" not in run.spec:
        detail = (
            f"A run of `{run.experiment}` fills no archive; its result is at "
            f"/api/v1/runs/{run.id}/results."
        )
        raise Refused(404, "No archive", detail)


def _elites(session: Session, run: Run, as_of: int) -> Sequence[Any]:
    """The last of each cell that is not after a generation."""
    last = (
        select(Elite.cell, func.max(Elite.generation).label("generation"))
        .where(Elite.run_id == run.id, Elite.generation <= as_of)
        .group_by(Elite.cell)
        .subquery()
    )
    same = (Elite.cell == last.c.cell) & (Elite.generation == last.c.generation)
    statement = select(*COLUMNS).join(last, same).where(Elite.run_id == run.id)
    return session.execute(statement.order_by(Elite.cell)).all()


@router.get("/archive.h5", response_class=Response, responses=binary)
def download_archive(
    request: Request, run: RunDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The last checkpoint's file; of a run without an archive it holds the table."""
    artifact = _checkpoint(session, run)
    headers = {**_attachment(run, "h5"), "Cache-Control": "no-cache"}
    return ranges.file(request, services.artifacts, artifact, headers)


@router.get(
    "/archive.csv", response_class=Response, responses={200: {"content": {"text/csv": {}}}}
)
def download_table(run: RunDep, session: SessionDep, services: ServicesDep) -> Response:
    """The last checkpoint's archive in the columns of pyribs."""
    _refuse_without(run)
    table = export.csv(services.artifacts.read(_checkpoint(session, run).path))
    return Response(table, headers=_attachment(run, "csv"), media_type="text/csv")


def _checkpoint(session: Session, run: Run) -> Artifact:
    artifact = last_checkpoint(session, run.id)
    if artifact is None:
        detail = f"Run {run.id} has no checkpoint yet; it is {run.status}."
        raise Refused(404, "No checkpoint yet", detail)
    return artifact


def _attachment(run: Run, ending: str) -> dict[str, str]:
    kind = "archive" if "archive" in run.spec else run.experiment
    name = f"{kind}-{str(run.id)[:8]}.{ending}"
    return {"Content-Disposition": f'attachment; filename="{name}"'}
