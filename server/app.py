"""The application, put together."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from functools import partial

from fastapi import FastAPI

from microcosmos.version import VERSION

from . import migrations, problems
from .description import describe
from .guard import Guard
from .hub import Hub
from .metrics import Counting, Requests
from .reconcile import reconciling
from .routes import api, health, metrics, page
from .services import Services, connect
from .settings import Settings
from .shutdown import told_to_stop


def create() -> FastAPI:
    """What uvicorn starts: the application as the environment wants it."""
    settings = Settings()
    settings.refuse_exposure()
    return create_app(connect(settings))


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
    describe(app)
    token = services.settings.token
    app.add_middleware(Guard, token=token.get_secret_value() if token else None)
    app.state.requests = requests = Requests()
    app.add_middleware(Counting, requests=requests)
    for router in (api, health.router, metrics.router, page.router):
        app.include_router(router)
    return app


@asynccontextmanager
async def _life(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    await asyncio.to_thread(migrations.upgrade, services.sessions)
    app.state.hub = hub = Hub(services.settings.redis_url, services.events.stream)
    await hub.begin()
    reading = asyncio.create_task(hub.run())
    app.state.end_streams = partial(asyncio.get_running_loop().call_soon_threadsafe, hub.close)
    with reconciling(services), told_to_stop(app.state.end_streams):
        yield
    hub.close()
    reading.cancel()
    with suppress(asyncio.CancelledError):
        await reading
    await hub.redis.aclose()
    services.close()
