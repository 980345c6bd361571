"""Routes of liveness, readiness, metrics and the health report."""

from typing import Literal

from fastapi import APIRouter, Request, Response
from fastapi.responses import PlainTextResponse
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from redis import RedisError
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from ..auth.authorize import MAY_ADMINISTER, MAY_READ, PUBLIC
from ..core import static_files
from ..core.schemas import Wire
from ..services.services import ServicesDep, SessionDep
from ..storage import mark, space
from . import health_report

router = APIRouter(tags=["health"])
"""Routes of the API."""
outside = APIRouter(tags=["health"])
"""Routes whose path does not start with `/api`."""


class Health(Wire):
    status: Literal["ok"] = "ok"
    help: bool
    """The documentation is served at `/help/`."""


Answer = Literal["ok", "unreachable"]


class Readiness(Wire):
    database: Answer
    redis: Answer
    store: Literal["ok", "wrong or unreachable"]
    disk: Literal["ok", "almost full", "full", "none"]
    """`almost full` is a warning: the server is ready all the same. `none`: files are in an
    object store and rows in PostgreSQL, whose disks this machine does not see."""


@router.get("/health", dependencies=[MAY_ADMINISTER])
def read_health(services: ServicesDep) -> health_report.HealthReport:
    """Return the state of the database, the disk, Redis, the queues and the workers."""
    return health_report.report(services)


@outside.get("/healthz", dependencies=[PUBLIC])
async def alive() -> Health:
    """Answer without a thread: all may be waiting for something else."""
    return Health(help=static_files.DOCUMENTATION.is_dir())


@outside.get("/readyz", responses={503: {"model": Readiness}}, dependencies=[PUBLIC])
def ready(services: ServicesDep, session: SessionDep, response: Response) -> Readiness:
    found = Readiness(database="ok", redis="ok", store="ok", disk="ok")
    if not any(space.folders(services.settings, services.artifacts)):
        found.disk = "none"
    if space.shortage(services.settings, services.artifacts):
        full = space.is_full(services.settings, services.artifacts)
        found.disk = "full" if full else "almost full"
    try:
        session.execute(text("SELECT 1"))
        if mark.fault(services.sessions, services.artifacts):
            found.store = "wrong or unreachable"
    except SQLAlchemyError:
        found.database = "unreachable"
    try:
        services.redis.ping()
    except RedisError:
        found.redis = "unreachable"
    if {found.database, found.redis, found.store} != {"ok"} or found.disk == "full":
        response.status_code = 503
    return found


@outside.get("/metrics", include_in_schema=False, dependencies=[MAY_READ])
def metrics(request: Request) -> PlainTextResponse:
    content = request.app.state.metrics.text()
    return PlainTextResponse(content, media_type=CONTENT_TYPE_PLAIN_0_0_4)
