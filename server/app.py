"""The application, put together."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

from fastapi import APIRouter, FastAPI
from fastapi.responses import JSONResponse

from microcosmos.version import VERSION

from .archives import result_routes as results_api
from .archives import routes as archives_api
from .auth import bootstrap
from .auth import routes as tokens_api
from .auth.authenticate import Authenticator
from .auth.authorize import MAY_READ, PUBLIC
from .auth.capability import HEADER
from .auth.middleware import PrincipalMiddleware
from .auth.tokens import watch
from .core import errors, nowhere, page, request_log
from .core.openapi import PROBLEMS, describe
from .core.security_headers import Discretion
from .core.shutdown import on_shutdown
from .creatures import network_routes as networks_api
from .creatures import routes as creatures_api
from .creatures.sandbox import sandbox
from .deletion import routes as deletion_api
from .estimates import routes as queue_api
from .events import routes as events_api
from .events.fanout import Hub
from .forks import routes as forks_api
from .maintenance import routes as health_api
from .maintenance.metrics import CountRequests, Metrics
from .maintenance.reconcile import reconciling
from .renderings import measurement_routes as measurements_api
from .renderings import routes as renderings_api
from .runs import detail_routes as details_api
from .runs import routes as runs_api
from .services.services import Services, connect
from .settings import Settings
from .shares import page as share_page
from .shares import routes as shares_api
from .shares.capability import open_share
from .specs import routes as experiments_api
from .sweeps import routes as sweeps_api
from .tables import migrations
from .workers import routes as workers_api


def create() -> FastAPI:
    """What uvicorn starts: the application as the environment wants it."""
    return create_app(connect(Settings()))


def create_app(services: Services) -> FastAPI:
    """The application over services, which it closes when it ends."""
    app = FastAPI(
        title="Microcosmos",
        version=VERSION,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        lifespan=_life,
    )
    app.state.services = services
    errors.install(app)
    request_log.install()
    describe(app)
    app.state.authenticator = authenticator = Authenticator(services)
    app.add_middleware(
        PrincipalMiddleware,
        authenticator=authenticator,
        open_share=partial(open_share, services),
    )
    app.add_middleware(Discretion, share_header=HEADER)
    app.state.metrics = metrics = Metrics(services)
    app.add_middleware(CountRequests, metrics=metrics)
    api = APIRouter(prefix="/api/v1", responses=PROBLEMS)
    for noun in (
        experiments_api,
        runs_api,
        forks_api,
        deletion_api,
        sweeps_api,
        details_api,
        archives_api,
        results_api,
        creatures_api,
        networks_api,
        renderings_api,
        measurements_api,
        shares_api,
        events_api,
        workers_api,
        queue_api,
        tokens_api,
        health_api,
    ):
        api.include_router(noun.router)
    api.include_router(_description(app))
    api.include_router(nowhere.router, dependencies=[MAY_READ])
    app.include_router(api)
    app.include_router(health_api.outside)
    for public in (share_page.router, page.router):
        app.include_router(public, dependencies=[PUBLIC])
    return app


def _description(app: FastAPI) -> APIRouter:
    """Return the route of the OpenAPI document, which needs a token as the others do."""
    router = APIRouter(include_in_schema=False, dependencies=[MAY_READ])
    router.add_api_route("/openapi.json", lambda: JSONResponse(app.openapi()))
    return router


@asynccontextmanager
async def _life(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    await asyncio.to_thread(migrations.upgrade, services.sessions)
    await asyncio.to_thread(bootstrap.refuse_without_admin, services)
    app.state.hub = hub = Hub(services.settings.redis_url, services.events.stream)
    await hub.begin()
    tasks = [
        asyncio.create_task(task) for task in (hub.run(), watch(services, hub.tokens, hub.end))
    ]
    app.state.end_streams = partial(asyncio.get_running_loop().call_soon_threadsafe, hub.close)
    await asyncio.to_thread(sandbox().start)
    with reconciling(services), on_shutdown(app.state.end_streams):
        yield
    hub.close()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    await hub.redis.aclose()
    services.close()
