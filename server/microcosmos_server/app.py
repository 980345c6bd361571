"""Assemble the application."""

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from multiprocessing import parent_process
from signal import SIGTERM

from fastapi import APIRouter, FastAPI

from microcosmos.version import VERSION

from .archives import routes as archives
from .auth import bootstrap
from .auth import routes as tokens
from .auth.authenticate import Authenticator
from .auth.authorize import MAY_READ, PUBLIC, SHARE_HEADER
from .auth.middleware import PrincipalMiddleware
from .auth.tokens import watch
from .choices import routes as choices
from .core import api, errors, logs, static_files
from .core.answers import AnswerCache
from .core.logs import RequestId
from .core.processes import die_with_parent, on_stop_signal
from .core.security_headers import SecurityHeaders, redact_request_log
from .creatures import routes as creatures
from .creatures import units
from .creatures.sandbox import sandbox
from .estimates import routes as queue
from .events import routes as events
from .events import schemas as event_schemas
from .exports import routes as exports
from .forks import routes as forks
from .maintenance import routes as health
from .maintenance.metrics import CountRequests, Metrics
from .maintenance.reconcile import reconciling
from .notifications import delivery
from .phylogenies import routes as phylogenies
from .renderings import routes as renderings
from .runs import routes as runs
from .services.services import Services, connect
from .settings import Settings
from .shares import page as share_page
from .shares import routes as shares
from .shares.access import open_share
from .specs import routes as experiments
from .statistics import routes as statistics
from .storage import mark
from .sweeps import routes as sweeps
from .tables import migrations
from .tank import routes as tank
from .workers import routes as workers

ROUTES = (
    *(
        experiments,
        runs,
        choices,
        forks,
        sweeps,
        statistics,
        archives,
        phylogenies,
        exports,
        creatures,
        units,
    ),
    *(renderings, tank, shares, events, workers, queue, tokens, health),
)

KEPT_ANSWERS = 80 << 20
"""Bytes of answers that a process keeps."""
ANSWER_THREADS = 4
"""Answers that a process makes at once."""

log = logging.getLogger(__name__)


def create() -> FastAPI:
    """Return the application for uvicorn, with the settings of the environment.

    One of several processes ends with the one that started it.
    """
    settings = Settings()
    if parent := parent_process():
        die_with_parent(parent.pid or 0, SIGTERM)
        logs.set_up(settings)
    return create_app(connect(settings))


def create_app(services: Services) -> FastAPI:
    """Return the application over services, which it closes at its end."""
    app = FastAPI(
        title="Microcosmos",
        version=VERSION,
        # FastAPI's own routes of the document would need no token.
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        lifespan=_lifespan,
    )
    app.state.services = services
    app.state.authenticator = Authenticator(services)
    app.state.metrics = Metrics(services)
    app.state.writable = health.Writable(services.artifacts)
    app.state.answers = AnswerCache(KEPT_ANSWERS, ANSWER_THREADS)
    errors.install(app)
    redact_request_log()
    api.describe(app, event_schemas.describe)
    app.add_middleware(
        PrincipalMiddleware,
        authenticator=app.state.authenticator,
        open_share=partial(open_share, services),
    )
    app.add_middleware(api.AsBytes)
    app.add_middleware(api.HTTPRules)
    app.add_middleware(SecurityHeaders, share_header=SHARE_HEADER)
    app.add_middleware(CountRequests, metrics=app.state.metrics)
    # The last one is the outermost: it gives an id to each line of the log, and the counting
    # before it sees the requests that are refused.
    app.add_middleware(RequestId)
    router = APIRouter(prefix="/api/v1", responses=api.PROBLEMS)
    for package in ROUTES:
        router.include_router(package.router)
    router.include_router(api.fallback, dependencies=[MAY_READ])
    app.include_router(router)
    app.include_router(health.outside)
    app.webhooks.include_router(delivery.webhooks)
    for public in (share_page.router, static_files.router):
        app.include_router(public, dependencies=[PUBLIC])
    return app


def mark_store(services: Services) -> None:
    """Mark a new store. The server also starts with a wrong one: the database can be read."""
    try:
        mark.leave(services.sessions, services.artifacts)
    except OSError as error:
        log.error("The store cannot be marked: %s", error)
    if fault := mark.fault(services.sessions, services.artifacts):
        log.error("%s", fault)


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    # In threads: another server may hold the lock of the migrations for long.
    await asyncio.to_thread(migrations.upgrade, services.sessions)
    await asyncio.to_thread(bootstrap.refuse_without_admin, services)
    await asyncio.to_thread(mark_store, services)
    fanout = events.Fanout(services.settings.redis_url, services.events.stream)
    app.state.fanout = fanout
    # Before the first request, so that no client misses an event after the state that it reads.
    await fanout.start()
    tasks = [
        asyncio.create_task(task)
        for task in (fanout.run(), watch(services, fanout.tokens, fanout.end))
    ]
    # A signal interrupts any code, also the loop's own: its handler may only schedule a call.
    close = partial(asyncio.get_running_loop().call_soon_threadsafe, fanout.close)
    app.state.end_streams = close
    await asyncio.to_thread(sandbox().start)
    with reconciling(services), delivery.notifying(services), on_stop_signal(close):
        yield
    fanout.close()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    await fanout.redis.aclose()
    # In a thread: it waits for answers that are being made.
    await asyncio.to_thread(app.state.answers.close)
    services.close()
