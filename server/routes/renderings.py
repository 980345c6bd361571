"""What can be seen of a creature: its recorded motion, films, pictures, its audit."""

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import JSONResponse, Response

from .. import motions, ranges, renderings
from ..deps import CreatureDep, ServicesDep, SessionDep
from ..models import AUDIT, GIF, MP4, REPLAY, STRIP
from ..problems import Refused
from ..queue import FAILURE_KEPT
from ..schemas import Rendering
from ..services import Services

MEDIA_TYPES = {
    REPLAY: "application/octet-stream",
    AUDIT: "application/json",
    STRIP: "image/png",
    GIF: "image/gif",
    MP4: "video/mp4",
}
WORDS = {AUDIT: "audit", STRIP: "picture", GIF: "film", MP4: "film"}

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])


def _reader(kind: str) -> Callable[..., Response]:
    def read(
        request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
    ) -> Response:
        artifact = renderings.find(session, row.sha256, kind)
        if artifact:
            headers = {"Cache-Control": "no-cache", **_named(row.sha256, kind)}
            return ranges.file(
                request, services.artifacts, artifact, headers, MEDIA_TYPES[kind]
            )
        return _ordered(services, row.sha256, kind)

    read.__name__ = f"read_{kind.replace('.', '_')}"
    read.__doc__ = f"The {WORDS.get(kind, kind)}, or 202 while it is made."
    return read


def _ordered(services: Services, sha: str, kind: str) -> Response:
    """Says that a rendering is being made, or why it cannot be."""
    try:
        renderings.order(services, sha, kind)
    except renderings.RenderingFailed as error:
        made = f"The {WORDS.get(kind, kind)} could not be made"
        detail = f"{made}: {error}. It can be tried again in a minute."
        headers = {"Retry-After": str(FAILURE_KEPT)}
        raise Refused(500, "Rendering failed", detail, headers=headers) from error
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})


def _named(sha: str, kind: str) -> dict[str, str]:
    """How a file is called that somebody keeps."""
    if kind in (REPLAY, AUDIT):
        return {}
    name = f"creature-{sha[:12]}.{kind.rpartition('.')[2]}"
    return {"Content-Disposition": f'inline; filename="{name}"'}


for kind, media_type in MEDIA_TYPES.items():
    answers: dict[int | str, dict[str, Any]] = {
        200: {"content": {media_type: {}}},
        202: {"model": Rendering},
    }
    router.get(f"/{kind}", response_class=Response, responses=answers)(_reader(kind))


@router.get(
    "/motion",
    response_class=Response,
    responses={200: {"content": {"application/octet-stream": {}}}, 202: {"model": Rendering}},
)
def read_motion(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The body's motion alone, of the same recording as the replay; or 202 while it is made."""
    replay = renderings.find(session, row.sha256, REPLAY)
    if not replay:
        return _ordered(services, row.sha256, REPLAY)
    headers = {"Cache-Control": "no-cache", "ETag": f'"motion-{replay.sha256}"'}
    if headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    content = motions.motion(services.artifacts, replay)
    return Response(content, headers=headers, media_type="application/octet-stream")
