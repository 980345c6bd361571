"""Routes of liveness and readiness."""

from typing import Literal

from fastapi import APIRouter, Response
from redis import RedisError
from sqlalchemy import text
from sqlalchemy.exc import SQLAlchemyError

from ..core import page
from ..core.schemas import Wire
from ..services.deps import ServicesDep
from ..services.services import Services

router = APIRouter(tags=["health"])
Answer = Literal["ok", "unreachable"]


class Health(Wire):
    status: Literal["ok"] = "ok"
    help: bool
    """The documentation is served at `/help/`."""


class Readiness(Wire):
    database: Answer
    redis: Answer


@router.get("/healthz")
def alive() -> Health:
    return Health(help=page.HELP.is_dir())


@router.get("/readyz", responses={503: {"model": Readiness}})
def ready(services: ServicesDep, response: Response) -> Readiness:
    found = Readiness(database=_database(services), redis=_redis(services))
    if "unreachable" in (found.database, found.redis):
        response.status_code = 503
    return found


def _database(services: Services) -> Answer:
    try:
        with services.sessions.read() as session:
            session.execute(text("SELECT 1"))
    except SQLAlchemyError:
        return "unreachable"
    return "ok"


def _redis(services: Services) -> Answer:
    try:
        services.redis.ping()
    except RedisError:
        return "unreachable"
    return "ok"
