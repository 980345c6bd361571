"""The route of a first creature: what a run would begin with, before it is queued."""

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import JSONResponse, Response

from microcosmos import naming
from microcosmos.archive import columns
from microcosmos.spec import Evolution

from ..auth.authorize import MAY_WRITE
from ..core.api import sends
from ..core.errors import ProblemError
from ..core.json_body import json_route
from ..queue.jobs import FIRST
from ..services.services import ServicesDep
from ..specs.deps import SPEC_BYTES, SpecDep
from . import storage
from .responses import PENDING
from .schemas import Rendering

router = APIRouter(tags=["runs"], route_class=json_route(SPEC_BYTES))


@router.post("/first-creature", **sends(columns.MEDIA_TYPE, PENDING), dependencies=[MAY_WRITE])
def read_first_creature(
    spec: SpecDep, services: ServicesDep, number: Annotated[int, Query(ge=0, lt=1 << 31)] = 0
) -> Response:
    """Return the inputs of the evaluation of a creature of a run's first generation.

    202 while a renderer makes them. `number` counts within the generation, again and again.
    The answer is kept for ten minutes; no run is queued and no creature is stored.
    """
    if not isinstance(spec, Evolution) or spec.search.initial:
        detail = "Only a search that starts from random creatures has such a first generation."
        raise ProblemError(422, "No random creatures", detail)
    document = spec.model_dump(mode="json")
    number %= spec.search.batch
    name = naming.name({"spec": document, "number": number})
    if (inputs := services.jobs.first(name)) is not None:
        return Response(inputs, media_type=columns.MEDIA_TYPE)
    job = services.jobs.find(services.jobs.rendering_id(name, FIRST))
    if not storage.is_underway(job, FIRST):
        services.jobs.order_first(name, document, number)
    return JSONResponse(Rendering().model_dump(), 202, {"Retry-After": "1"})
