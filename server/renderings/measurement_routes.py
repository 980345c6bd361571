"""Whether a creature does here what its file says: measured again when somebody asks."""

from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import Response

from ..auth.authorize import MAY_READ_SHARED, MAY_WRITE
from ..auth.capability import SharedViewDep
from ..core.errors import ProblemError
from ..creatures.deps import CreatureDep
from ..creatures.schemas import Measurement, Rendering
from ..services.deps import ServicesDep, SessionDep
from ..tables import MEASUREMENT
from . import storage as renderings
from .reading import kept, ordered

router = APIRouter(prefix="/creatures/{sha}", tags=["creatures"])
Answers = dict[int | str, dict[str, Any]]
UNDERWAY: Answers = {202: {"model": Rendering}}
NEVER: Answers = {204: {"description": "Nobody has had it measured here"}}


@router.post("/measure", status_code=202, dependencies=[MAY_WRITE])
def measure(row: CreatureDep, services: ServicesDep) -> Rendering:
    """Have it evaluated again, by the program that measured it; then read `measurement`."""
    if not row.measured:
        detail = "Its file holds no measurement: there is nothing to compare a new one with."
        raise ProblemError(422, "Never measured", detail)
    if not renderings.underway(services, row.sha256, MEASUREMENT):
        renderings.forget(services, row.sha256, MEASUREMENT)
        services.jobs.render(row.sha256, MEASUREMENT)
    return Rendering()


@router.get(
    "/measurement",
    responses={200: {"model": Measurement}, **UNDERWAY, **NEVER},
    dependencies=[MAY_READ_SHARED],
)
def read_measurement(
    request: Request,
    row: CreatureDep,
    share: SharedViewDep,
    session: SessionDep,
    services: ServicesDep,
) -> Response:
    """What came of it; 202 while it is measured, 204 where nobody has asked for it."""
    if found := kept(request, row, session, services, MEASUREMENT):
        return found
    if share:
        return Response(status_code=204)
    job = services.jobs.find(services.jobs.rendering_id(row.sha256, MEASUREMENT))
    return ordered(services, row.sha256, MEASUREMENT) if job else Response(status_code=204)
