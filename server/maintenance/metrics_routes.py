"""Numbers for Prometheus, which name nothing and nobody."""

from fastapi import APIRouter, Request
from fastapi.responses import PlainTextResponse

from ..auth.authorize import MAY_READ
from ..services.deps import ServicesDep
from .metrics import measured

router = APIRouter(include_in_schema=False)
FORMAT = "text/plain; version=0.0.4; charset=utf-8"


@router.get("/metrics", dependencies=[MAY_READ])
def metrics(services: ServicesDep, request: Request) -> PlainTextResponse:
    families = [*measured(services), *request.app.state.requests.families()]
    lines = [line for family in families for line in family.lines()]
    return PlainTextResponse("\n".join(lines) + "\n", media_type=FORMAT)
