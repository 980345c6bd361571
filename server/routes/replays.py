"""The recorded motion of a creature."""

from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import JSONResponse, Response

from .. import ranges, replays
from ..deps import CreatureDep, ServicesDep, SessionDep
from ..problems import Refused
from ..queue import FAILURE_KEPT
from ..schemas import Rendering

router = APIRouter(prefix="/creatures/{sha}/replay", tags=["creatures"])
answers: dict[int | str, dict[str, Any]] = {
    200: {"content": {"application/octet-stream": {}}},
    202: {"model": Rendering},
}


@router.get("", response_class=Response, responses=answers)
def read_replay(
    request: Request, row: CreatureDep, session: SessionDep, services: ServicesDep
) -> Response:
    """The replay, or 202 while it is made."""
    artifact = replays.find(session, row.sha256)
    if artifact:
        return ranges.file(request, services.artifacts, artifact, {"Cache-Control": "no-cache"})
    try:
        replays.order(services, row.sha256)
    except replays.RenderingFailed as error:
        detail = f"The replay could not be made: {error}. It can be tried again in a minute."
        headers = {"Retry-After": str(FAILURE_KEPT)}
        raise Refused(500, "Rendering failed", detail, headers=headers) from error
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})
