"""Answer with a rendering that exists, or order it."""

from fastapi import Request
from fastapi.responses import JSONResponse, Response
from sqlalchemy.orm import Session

from ..core.errors import ProblemError
from ..creatures.schemas import Rendering
from ..queue.jobs import FAILURE_SECONDS
from ..services.services import Services
from ..storage import ranges
from ..tables import AUDIT, GIF, MEASUREMENT, MP4, PREVIEW, REPLAY, STRIP, Creature
from . import motions
from . import storage as renderings

MEDIA_TYPES = {
    REPLAY: "application/octet-stream",
    AUDIT: "application/json",
    STRIP: "image/png",
    PREVIEW: "image/png",
    GIF: "image/gif",
    MP4: "video/mp4",
    MEASUREMENT: "application/json",
}
ON_SIGHT = (REPLAY, AUDIT, STRIP, PREVIEW, GIF, MP4)
"""What is made as soon as somebody wants to see it."""
WORDS = {AUDIT: "audit", STRIP: "picture", PREVIEW: "picture", GIF: "film", MP4: "film"}


def kept(
    request: Request, row: Creature, session: Session, services: Services, kind: str
) -> Response | None:
    """A rendering that is there already."""
    artifact = renderings.find(session, row.sha256, kind)
    if artifact is None:
        return None
    headers = {"Cache-Control": "no-cache", **_named(row.sha256, kind)}
    return ranges.file(request, services.artifacts, artifact, headers, MEDIA_TYPES[kind])


def ordered(services: Services, sha: str, kind: str, *, anonymous: bool = False) -> Response:
    """Says that a rendering is being made, or why it cannot be.

    The holder of a share is not told why: the words of errors may name files and hosts.
    """
    try:
        renderings.order(services, sha, kind, anonymous=anonymous)
    except renderings.RenderingFailed as error:
        why = "" if anonymous else f": {error}"
        detail = f"The {WORDS.get(kind, kind)} could not be made{why}. "
        detail += "It can be tried again in a minute."
        headers = {"Retry-After": str(FAILURE_SECONDS)}
        raise ProblemError(500, "Rendering failed", detail, headers=headers) from error
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})


def _named(sha: str, kind: str) -> dict[str, str]:
    """How a file is called that somebody keeps."""
    if kind in (REPLAY, AUDIT, MEASUREMENT):
        return {}
    name = f"creature-{sha[:12]}.{kind.rpartition('.')[2]}"
    return {"Content-Disposition": f'inline; filename="{name}"'}


def kept_motion(
    request: Request, row: Creature, session: Session, services: Services
) -> Response | None:
    replay = renderings.find(session, row.sha256, REPLAY)
    if replay is None:
        return None
    headers = {"Cache-Control": "no-cache", "ETag": f'"motion-{replay.sha256}"'}
    if headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    content = motions.motion(services.artifacts, replay)
    return Response(content, headers=headers, media_type="application/octet-stream")
