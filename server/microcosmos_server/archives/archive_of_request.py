"""Find the archive that a request names; answer about it as JSON or as binary columns."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any
from uuid import UUID

import numpy as np
from fastapi import Depends, Request
from fastapi.responses import Response
from sqlalchemy import select
from sqlalchemy.orm import Session

from microcosmos.archive import columns
from microcosmos.version import VERSION

from ..attempts.checkpoints import last_checkpoint
from ..auth.authorize import ShareAccessDep
from ..core.answers import accepts, respond, tag_of
from ..core.errors import NotFound
from ..runs import deps
from ..services.services import Services, ServicesDep
from ..storage import segments
from ..tables import TERMINAL, Artifact, InstallationState, Run
from . import measures
from .schemas import HistoryRead

JSON = "application/json"
TYPES = {"fitness": "float64", "descriptors": "float64"}
"""Types of columns in bytes, but for integers of 32 bits."""
UNKNOWN = -1
"""A verdict in bytes where JSON has null."""


@dataclass(frozen=True)
class ShownArchive:
    """The archive of a run, or what a share shows of it, in the state of one moment."""

    request: Request
    services: Services
    run: Run
    file: Artifact | None
    """The file that tells the learned axes: that of a share, or the last of an ended run."""
    state: tuple[Any, ...]
    """With it, everything that an answer says is fixed."""

    async def answer(
        self, read: Callable[[Session], HistoryRead], *asked: str | int | None
    ) -> Response:
        """Return the archive that `read` reads, in the form that the request accepts.

        The answer is made once for each state and for what was `asked`, over a connection of
        its own.
        """
        in_columns = accepts(self.request, "accept", columns.MEDIA_TYPE)
        media_type = columns.MEDIA_TYPE if in_columns else JSON

        def make() -> bytes:
            with self.services.sessions.read() as session:
                found = read(session)
            return found.model_dump_json().encode() if media_type == JSON else _bytes(found)

        tag = tag_of(self.state, self.request.scope["route"].path, asked, media_type)
        headers = {"Vary": "Accept, Accept-Encoding"}
        return await respond(self.request, tag, make, media_type, headers)


def _shown(
    run_id: UUID, request: Request, services: ServicesDep, share: ShareAccessDep
) -> ShownArchive:
    """Find an archive over a connection that is closed again: answers may take seconds."""
    with services.sessions.read() as session:
        run = deps.run(run_id, session, share)
        refuse_table(run)
        verdicts = session.scalars(select(InstallationState.verdicts)).one()
        # While a run goes on, its axes change, and earlier creatures would have to be read
        # again. A share keeps the axes of its own file.
        if share:
            file = share.archive(session)
        else:
            file = last_checkpoint(session, run.id) if run.status in TERMINAL else None
    told = file and segments.whole(file).sha256
    state = (VERSION, run.id, run.rewinds, run.generation, told, verdicts)
    return ShownArchive(request, services, run, file, state)


ShownArchiveDep = Annotated[ShownArchive, Depends(_shown)]


def refuse_table(run: Run) -> None:
    """Raise `DomainError` unless the run has an archive."""
    if not measures.has_archive(run):
        detail = (
            f"A run of `{run.experiment}` has no archive; its result is the table at "
            f"/api/v1/runs/{run.id}/results."
        )
        raise NotFound(detail, title="No archive")


def _bytes(read: HistoryRead) -> bytes:
    """Write the columns as arrays; everything else is in the header."""
    names = [
        name for name in HistoryRead.model_fields if name not in ("generation", "measures")
    ]
    header = read.model_dump(mode="json", exclude={*names, "measures"})
    arrays = {name: _array(name, getattr(read, name)) for name in names}
    for name, values in read.measures.items():
        arrays[f"measures.{name}"] = np.array(values, np.float64)  # None becomes NaN.
    return columns.dump(header, arrays)


def _array(name: str, values: list[Any]) -> np.ndarray:
    if name == "creature":
        return np.frombuffer(bytes.fromhex("".join(values)), np.uint8).reshape(-1, 32)
    if name == "trusted":
        return np.array([UNKNOWN if one is None else one for one in values], np.int8)
    return np.array(values, TYPES.get(name, "int32"))


def archive_answers(model: type[HistoryRead]) -> dict[str, Any]:
    """Return the arguments of a route whose answer is JSON or columns, for OpenAPI."""
    content = {columns.MEDIA_TYPE: {"schema": {"type": "string", "format": "binary"}}}
    responses = {200: {"model": model, "content": content}, 304: {"description": "Unchanged"}}
    return {"responses": responses}
