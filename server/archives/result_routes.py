"""The result of a run that is a table: one row for each thing measured."""

import csv
import io
from typing import Any

from fastapi import APIRouter
from fastapi.responses import Response
from sqlalchemy import select
from sqlalchemy.orm import Session

from ..auth.authorize import MAY_READ
from ..core.errors import ProblemError
from ..runs.deps import RunDep
from ..services.deps import SessionDep
from ..tables import Result, Run
from . import measures as of_elites
from .schemas import ResultsRead

router = APIRouter(prefix="/runs/{run_id}", tags=["results"])


@router.get("/results", dependencies=[MAY_READ])
def read_results(run: RunDep, session: SessionDep) -> ResultsRead:
    """All rows so far, in the order in which they were measured."""
    return ResultsRead(generation=run.generation, summary=run.summary, rows=_rows(session, run))


@router.get(
    "/results.csv",
    response_class=Response,
    responses={200: {"content": {"text/csv": {}}}},
    dependencies=[MAY_READ],
)
def download_results(run: RunDep, session: SessionDep) -> Response:
    """The same as a table."""
    _refuse_archive(run)
    rows = _rows(session, run)
    if not rows:
        detail = f"Run {run.id} has no results yet; it is {run.status}."
        raise ProblemError(404, "No results yet", detail)
    name = f"{run.experiment}-{str(run.id)[:8]}.csv"
    headers = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(_table(rows), headers=headers, media_type="text/csv")


def _refuse_archive(run: Run) -> None:
    if of_elites.searched(run):
        detail = (
            f"A run of `{run.experiment}` fills an archive, at "
            f"/api/v1/runs/{run.id}/archive, and has no table."
        )
        raise ProblemError(404, "No table", detail)


def _rows(session: Session, run: Run) -> list[dict[str, Any]]:
    mine = select(Result).where(Result.run_id == run.id).order_by(Result.number)
    return [{**row.values, "creature": row.creature} for row in session.scalars(mine)]


def _table(rows: list[dict[str, Any]]) -> str:
    columns = list(dict.fromkeys(name for row in rows for name in row if name != "creature"))
    text = io.StringIO()
    table = csv.DictWriter(text, [*columns, "creature"], lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    return text.getvalue()
