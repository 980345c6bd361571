"""What can be seen of a creature: its recorded motion, films, pictures, its audit."""

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import Response

from ..auth.authorize import MAY_READ, MAY_READ_SHARED
from ..auth.capability import SharedViewDep
from ..core.errors import ProblemError
from ..creatures.deps import CreatureDep
from ..creatures.schemas import Rendering
from ..services.deps import ServicesDep, SessionDep
from ..tables import AUDIT, PREVIEW, REPLAY
from .reading import MEDIA_TYPES, ON_SIGHT, WORDS, kept, kept_motion, ordered

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])


def _reader(kind: str) -> Callable[..., Response]:
    def read(
        request: Request,
        row: CreatureDep,
        share: SharedViewDep,
        session: SessionDep,
        services: ServicesDep,
    ) -> Response:
        there = kept(request, row, session, services, kind)
        if there is None and share and kind != REPLAY:
            raise ProblemError(404, "Not found", f"The share holds no {WORDS[kind]} of it.")
        return there or ordered(services, row.sha256, kind, anonymous=share is not None)

    read.__name__ = f"read_{kind.replace('.', '_')}"
    read.__doc__ = f"The {WORDS.get(kind, kind)}, or 202 while it is made."
    return read


for kind in ON_SIGHT:
    answers: dict[int | str, dict[str, Any]] = {
        200: {"content": {MEDIA_TYPES[kind]: {}}},
        202: {"model": Rendering},
    }
    allowed = MAY_READ if kind in (AUDIT, PREVIEW) else MAY_READ_SHARED
    route = router.get(
        f"/{kind}", response_class=Response, responses=answers, dependencies=[allowed]
    )
    route(_reader(kind))


@router.get(
    "/motion",
    response_class=Response,
    responses={200: {"content": {"application/octet-stream": {}}}, 202: {"model": Rendering}},
    dependencies=[MAY_READ_SHARED],
)
def read_motion(
    request: Request,
    row: CreatureDep,
    share: SharedViewDep,
    session: SessionDep,
    services: ServicesDep,
) -> Response:
    """The body's motion alone, of the same recording as the replay; or 202 while it is made."""
    there = kept_motion(request, row, session, services)
    return there or ordered(services, row.sha256, REPLAY, anonymous=share is not None)
