"""Routes of exports: a run in the formats of other programs."""

from dataclasses import dataclass
from functools import partial
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.responses import Response

from microcosmos.archive.quantities import Real
from microcosmos.exports.arrow import WRITERS
from microcosmos.exports.formats import ENDINGS, MEDIA_TYPES, Format, refuse_without_columns
from microcosmos.sizes import size
from microcosmos.version import VERSION

from ..archives.shown import refuse_table
from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import MAY_READ
from ..core.answers import respond, tag_of
from ..core.api import sends
from ..core.errors import ProblemError
from ..runs.deps import find_run
from ..services.services import Services, ServicesDep
from ..tables import Artifact, Run
from . import making

router = APIRouter(prefix="/runs/{run_id}", tags=["exports"])

ZIP = "application/zip"
LARGEST = 200_000_000
"""Bytes of a run's file that the server exports; `microcosmos export` takes any."""


@dataclass(frozen=True)
class Exported:
    """A run, its last checkpoint, and the format."""

    run: Run
    checkpoint: Artifact
    form: Format
    real: Real | None
    """Real quantities, for columns in SI units."""

    @property
    def headers(self) -> dict[str, str]:
        ending = ENDINGS.get(self.form, "zip")
        name = f"{making.name_of(self.run)}-{self.form}.{ending}"
        return {"Content-Disposition": f'attachment; filename="{name}"'}


def _real(
    form: Format,
    length: Annotated[str | None, Query(max_length=50)] = None,
    period: Annotated[str | None, Query(max_length=50)] = None,
) -> Real | None:
    """Read the real length of a body, such as `1mm`, and the period of a stroke, such as
    `0.5s`; raise `ProblemError` for others, and for a format without columns."""
    try:
        real = Real.of(length, period)
        if real is not None:
            refuse_without_columns(form)
    except ValueError as error:
        raise ProblemError(422, "Cannot be exported", f"{error}.") from error
    return real


def _exported(
    run_id: UUID,
    form: Format,
    real: Annotated[Real | None, Depends(_real)],
    services: ServicesDep,
) -> Exported:
    """Find a run over a connection that is closed again: answers may take seconds."""
    with services.sessions.read() as session:
        run = find_run(session, run_id)
        if form not in WRITERS:
            refuse_table(run)
        found = last_checkpoint(session, run_id)
        if found is None:
            detail = f"Run {run.id} has no checkpoint yet; it is {run.status}."
            raise ProblemError(404, "No checkpoint yet", detail)
        if found.size > LARGEST:
            detail = (
                f"The file of run {run.id} has {size(found.size)}, more than the "
                f"{size(LARGEST)} that the server exports. On your machine: microcosmos "
                f"export {run.id} --as {form}"
            )
            raise ProblemError(422, "Run too large", detail)
        return Exported(run, found, form, real)


@router.get("/export/{form}", **sends(ZIP, {304: {}, 404: {}}), dependencies=[MAY_READ])
async def export_run(
    request: Request,
    found: Annotated[Exported, Depends(_exported)],
    services: ServicesDep,
) -> Response:
    """Return the last checkpoint of a run as `parquet`, `arrow` or `ro-crate` (a ZIP of
    several files), `netcdf`, `alife` or `newick`.

    With the real `length` of a body and the `period` of a stroke, tables and `netcdf` have
    columns in SI units too."""
    run, checkpoint, form = found.run, found.checkpoint, found.form
    state = run.id, run.name, checkpoint.sha256, run.rewinds, run.generation
    tag = tag_of(VERSION, form, *state, found.real)
    make = partial(_make, services, found)
    kept = request.app.state.archive_answers
    return await respond(request, kept, tag, make, MEDIA_TYPES.get(form, ZIP), found.headers)


def _make(services: Services, found: Exported) -> bytes:
    try:
        return making.make(services, found.run, found.checkpoint.path, found.form, found.real)
    except ValueError as error:
        raise ProblemError(422, "Cannot be exported", f"{error}.") from error
