"""Answer requests for renderings: send the file, or enqueue it."""

from fastapi import Request
from fastapi.responses import JSONResponse, Response
from sqlalchemy.orm import Session

from microcosmos.archive import columns

from ..core.api import Answers
from ..services.services import Services
from ..storage import ranges
from ..tables import (
    AUDIT,
    EVALUATION,
    GIF,
    LOOP,
    MEASUREMENT,
    MP4,
    PREVIEW,
    REPLAY,
    STRIP,
    Creature,
)
from . import storage
from .schemas import Rendering

MEDIA_TYPES = {
    REPLAY: "application/octet-stream",
    AUDIT: "application/json",
    STRIP: "image/png",
    PREVIEW: "image/png",
    GIF: "image/gif",
    MP4: "video/mp4",
    LOOP: "video/mp4",
    MEASUREMENT: "application/json",
    EVALUATION: columns.MEDIA_TYPE,
}
PENDING: Answers = {202: {"model": Rendering}}
ON_REQUEST = (REPLAY, STRIP, PREVIEW, LOOP, GIF, MP4, EVALUATION)
"""Renderings that the first request for them enqueues. Audits and measurements are ordered."""


def existing(
    request: Request, row: Creature, session: Session, services: Services, kind: str
) -> Response | None:
    """Return the answer with a rendering, or None if it does not exist."""
    artifact = storage.find(session, row.sha256, kind)
    if artifact is None:
        return None
    headers = {"Cache-Control": "no-cache"}
    if kind not in (REPLAY, AUDIT, MEASUREMENT, EVALUATION):
        name = f"creature-{row.sha256[:12]}.{kind.rpartition('.')[2]}"
        headers["Content-Disposition"] = f'inline; filename="{name}"'
    return ranges.file(request, services.artifacts, artifact, headers, MEDIA_TYPES[kind])


def enqueued(services: Services, sha: str, kind: str, *, anonymous: bool = False) -> Response:
    """Enqueue a rendering and return 202; raise `RenderingFailed` if the last try failed."""
    storage.enqueue(services, sha, kind, anonymous=anonymous)
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})
