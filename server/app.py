"""The application, put together."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

from fastapi import FastAPI

from microcosmos.version import VERSION

from . import migrations, problems, request_log, tokens
from .access import Door
from .description import describe
from .discretion import Discretion
from .guard import Guard
from .hub import Hub
from .metrics import Counting, Requests
from .readers import quarantine
from .reconcile import reconciling
from .routes import api, health, metrics, page, share_page
from .services import Services, connect
from .settings import Settings
from .shutdown import told_to_stop
from .tokens.watching import watch


def create() -> FastAPI:
    """What uvicorn starts: the application as the environment wants it."""
    return create_app(connect(Settings()))


def create_app(services: Services) -> FastAPI:
    """The application over services, which it closes when it ends."""
    app = FastAPI(
        title="Microcosmos",
        version=VERSION,
        openapi_url="/api/v1/openapi.json",
        docs_url=None,
        redoc_url=None,
        lifespan=_life,
    )
    app.state.services = services
    problems.install(app)
    request_log.discreet()
    describe(app)
    app.state.door = door = Door(services)
    app.add_middleware(Guard, door=door)
    app.add_middleware(Discretion)
    app.state.requests = requests = Requests()
    app.add_middleware(Counting, requests=requests)
    for router in (api, health.router, metrics.router, share_page.router, page.router):
        app.include_router(router)
    return app


@asynccontextmanager
async def _life(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    await asyncio.to_thread(migrations.upgrade, services.sessions)
    await asyncio.to_thread(tokens.refuse_without_admin, services)
    app.state.hub = hub = Hub(services.settings.redis_url, services.events.stream)
    await hub.begin()
    tasks = [asyncio.create_task(task) for task in (hub.run(), watch(hub, services))]
    app.state.end_streams = partial(asyncio.get_running_loop().call_soon_threadsafe, hub.close)
    await asyncio.to_thread(quarantine().begin)
    with reconciling(services), told_to_stop(app.state.end_streams):
        yield
    hub.close()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    await hub.redis.aclose()
    services.close()
