"""Export a run in the formats of other programs, from its checkpoint and the database."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response
from sqlalchemy.orm import Session

from microcosmos.archive import choices as choices_file
from microcosmos.archive.phylogeny import Birth
from microcosmos.exports.arrow import WRITERS
from microcosmos.exports.crate import CHOICES, Extra, File
from microcosmos.exports.formats import (
    ENDINGS,
    MEDIA_TYPES,
    Format,
    files,
    refuse_without_columns,
    single,
    zipped,
)
from microcosmos.exports.run_file import FORMS, RunFile, hexes
from microcosmos.quantities.real import Real
from microcosmos.sizes import size
from microcosmos.version import VERSION

from ..archives.archive_of_request import refuse_table
from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import MAY_READ
from ..choices import choosing
from ..core.answers import respond, tag_of
from ..core.api import named, sends
from ..core.errors import Invalid, NotFound
from ..creatures import initial
from ..phylogenies import births
from ..runs.deps import find_run
from ..services.services import Services, ServicesDep
from ..storage import segments
from ..storage.segments import LARGEST
from ..tables import Artifact, Run

TREES = {
    Format.alife: ("csv",),
    Format.newick: ("nwk",),
    Format.ro_crate: ("csv", "nwk"),
}
"""Endings of the phylogenies that a format needs."""


def name_of(run: Run) -> str:
    return f"{run.experiment}-{str(run.id)[:8]}"


@dataclass(frozen=True)
class Exported:
    """A run, its last checkpoint, and the format."""

    run: Run
    checkpoint: Artifact
    form: Format
    real: Real | None
    """Real quantities, for columns in SI units."""
    ancestors: Sequence[Birth]
    """Those in other runs, for a format with phylogenies: other runs may change them."""

    @property
    def headers(self) -> dict[str, str]:
        ending = ENDINGS.get(self.form, "zip")
        return named(f"{name_of(self.run)}-{self.form}.{ending}")


def make(services: Services, found: Exported) -> bytes:
    """Return the one file of a run in a format, or a ZIP of several.

    Raises `ValueError` for a run that lacks what the format needs.
    """
    run, form, real = found.run, found.form, found.real
    data = segments.read(services.artifacts, found.checkpoint)
    with services.sessions.read() as session:
        trees = _trees(session, found)
        ended = run.finished_at and run.finished_at.isoformat(timespec="seconds")
        file = RunFile(name_of(run), data, trees, ended, run.name or "")
        extra = _extra(session, run, file) if form is Format.ro_crate else {}
    if form in ENDINGS:
        return single(file, form, real)
    written = files([file], form, extra={file.name: extra}, real=real)
    return zipped(written, f"{file.name}-{form}")


def _trees(session: Session, found: Exported) -> dict[str, bytes]:
    """Return phylogenies as of the checkpoint, with the ancestors in earlier runs."""
    endings = TREES.get(found.form, ())
    if not endings:
        return {}
    generation = found.checkpoint.generation or 0
    tree = births.of_run(session, found.run, found.ancestors, generation)
    return {ending: FORMS[ending](tree).encode() for ending in endings}


def _extra(session: Session, run: Run, file: RunFile) -> Extra:
    """Return the best creature, and the creatures that people chose, if there are any."""
    found: dict[str, File] = {}
    archive = file.archive()
    if len(archive["fitness"]):
        best = hexes(archive["creature"])[int(archive["fitness"].argmax())]
        for one in initial.files(session, [best]):
            about = "the best creature, for `microcosmos replay`"
            found["best.json"] = File(json.dumps(one, indent=1).encode(), about)
    counted = choosing.counted(session, run)
    rows = [(row.generation, row.creature) for row in counted if row.generation]
    if rows:
        creatures = initial.files(session, sorted({name for _, name in rows}))
        document = json.dumps(choices_file.document(rows, creatures), indent=1)
        about = "creatures that people chose, for `microcosmos evolve --choices`"
        found[CHOICES] = File(document.encode(), about)
    return found


router = APIRouter(prefix="/runs/{run_id}", tags=["exports"])

ZIP = "application/zip"


def _real(
    form: Format,
    length: Annotated[str | None, Query(max_length=50)] = None,
    period: Annotated[str | None, Query(max_length=50)] = None,
) -> Real | None:
    """Read the real length of a body, like `1mm`, and the period of a stroke, like `0.5s`.

    Raise `DomainError` for anything else, and for a format without columns.
    """
    try:
        real = Real.of(length, period)
        if real is not None:
            refuse_without_columns(form)
    except ValueError as error:
        raise Invalid(f"{error}.", title="Cannot be exported") from error
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
            raise NotFound(detail, title="No checkpoint yet")
        whole = segments.whole(found)
        if whole.size > LARGEST:
            detail = (
                f"The file of run {run.id} has {size(whole.size)}, more than the "
                f"{size(LARGEST)} that the server exports. On your machine: microcosmos "
                f"export {run.id} --as {form}"
            )
            raise Invalid(detail, title="Run too large")
        as_of = found.generation or 0
        above = births.ancestors_of_run(session, run, as_of) if form in TREES else ()
        return Exported(run, found, form, real, above)


@router.get("/export/{form}", **sends(ZIP, {304: {}, 404: {}}), dependencies=[MAY_READ])
async def export_run(
    request: Request,
    found: Annotated[Exported, Depends(_exported)],
    services: ServicesDep,
) -> Response:
    """Return the last checkpoint of a run in a format.

    `parquet`, `arrow` and `ro-crate` are a ZIP of several files; `netcdf`, `alife` and `newick`
    are one file. With the real `length` of a body and the `period` of a stroke, tables and
    `netcdf` have columns in SI units too.
    """
    run, checkpoint, form = found.run, found.checkpoint, found.form
    state = run.id, run.name, segments.whole(checkpoint).sha256, run.rewinds, run.generation
    of = (VERSION, form, *state, run.finished_at, found.real, found.ancestors)
    tag = await run_in_threadpool(tag_of, *of)
    make = partial(_make, services, found)
    return await respond(request, tag, make, MEDIA_TYPES.get(form, ZIP), found.headers)


def _make(services: Services, found: Exported) -> bytes:
    try:
        return make(services, found)
    except ValueError as error:
        raise Invalid(f"{error}.", title="Cannot be exported") from error
