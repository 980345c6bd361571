"""What can be seen of a creature: its recorded motion, films, pictures, its audit."""

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import JSONResponse, Response
from sqlalchemy.orm import Session

from ..auth.authorize import MAY_READ
from ..core.errors import ProblemError
from ..creatures.deps import CreatureDep
from ..creatures.schemas import Rendering
from ..queue.jobs import FAILURE_KEPT
from ..services.deps import ServicesDep, SessionDep
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

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])


def _reader(kind: str) -> Callable[..., Response]:
    def read(
        request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
    ) -> Response:
        return kept(request, row, session, services, kind) or ordered(
            services, row.sha256, kind
        )

    read.__name__ = f"read_{kind.replace('.', '_')}"
    read.__doc__ = f"The {WORDS.get(kind, kind)}, or 202 while it is made."
    return read


def kept(
    request: Request, row: Creature, session: Session, services: Services, kind: str
) -> Response | None:
    """A rendering that is there already."""
    artifact = renderings.find(session, row.sha256, kind)
    if artifact is None:
        return None
    headers = {"Cache-Control": "no-cache", **_named(row.sha256, kind)}
    return ranges.file(request, services.artifacts, artifact, headers, MEDIA_TYPES[kind])


def ordered(services: Services, sha: str, kind: str, *, patient: bool = False) -> Response:
    """Says that a rendering is being made, or why it cannot be.

    Strangers, who are `patient`, are not told why: words of errors may name files and hosts.
    """
    try:
        renderings.order(services, sha, kind, patient=patient)
    except renderings.RenderingFailed as error:
        why = "" if patient else f": {error}"
        detail = f"The {WORDS.get(kind, kind)} could not be made{why}. "
        detail += "It can be tried again in a minute."
        headers = {"Retry-After": str(FAILURE_KEPT)}
        raise ProblemError(500, "Rendering failed", detail, headers=headers) from error
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})


def _named(sha: str, kind: str) -> dict[str, str]:
    """How a file is called that somebody keeps."""
    if kind in (REPLAY, AUDIT, MEASUREMENT):
        return {}
    name = f"creature-{sha[:12]}.{kind.rpartition('.')[2]}"
    return {"Content-Disposition": f'inline; filename="{name}"'}


for kind in ON_SIGHT:
    answers: dict[int | str, dict[str, Any]] = {
        200: {"content": {MEDIA_TYPES[kind]: {}}},
        202: {"model": Rendering},
    }
    route = router.get(
        f"/{kind}", response_class=Response, responses=answers, dependencies=[MAY_READ]
    )
    route(_reader(kind))


@router.get(
    "/motion",
    response_class=Response,
    responses={200: {"content": {"application/octet-stream": {}}}, 202: {"model": Rendering}},
    dependencies=[MAY_READ],
)
def read_motion(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The body's motion alone, of the same recording as the replay; or 202 while it is made."""
    return kept_motion(request, row, session, services) or ordered(services, row.sha256, REPLAY)


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
