"""Metrics for Prometheus: this server's requests and statements, and the state."""

import os
import time
from collections.abc import Iterator
from typing import Any

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Histogram,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import InfoMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector
from sqlalchemy import Engine, QueuePool, event
from sqlalchemy.exc import SQLAlchemyError
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from microcosmos.version import VERSION

from ..core.database import MAX_CONNECTIONS
from ..core.processes import SHARED_METRICS
from ..services.services import Services
from . import state_metrics
from .state_metrics import gauge

BUCKETS = (0.005, 0.02, 0.05, 0.1, 0.25, 1.0, 5.0)
"""Upper bounds of the histograms of requests and statements, in seconds."""
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")

disable_created_metrics()


class Metrics(Collector):
    """Counts of this server since it started, and the state of the installation.

    The processes of one server count together, in files.
    """

    def __init__(self, services: Services):
        self.services, self.registry = services, CollectorRegistry()
        counted = CollectorRegistry()
        shared = SHARED_METRICS in os.environ
        for one in (self, MultiProcessCollector(None) if shared else counted):
            self.registry.register(one)  # pyright: ignore
        labels = ("method", "route", "status")
        self.requests = Counter(
            "microcosmos_requests", "Answered requests.", labels, registry=counted
        )
        self.seconds = Histogram(
            "microcosmos_request_seconds",
            "Seconds from a request to the start of its answer.",
            buckets=BUCKETS,
            registry=counted,
        )
        self.statements = Histogram(
            "microcosmos_database_statement_seconds",
            "Seconds that the database took for a statement of this server.",
            buckets=BUCKETS,
            registry=counted,
        )
        time_statements(services.sessions.engine, self.statements)

    def count(self, method: str, route: str, status: int, seconds: float) -> None:
        method = method if method in METHODS else "other"  # Clients may invent some.
        self.requests.labels(method, route, status).inc()
        self.seconds.observe(seconds)

    def collect(self) -> Iterator[Metric]:
        yield InfoMetricFamily("microcosmos", "The server.", {"version": VERSION})
        yield from self._database()
        yield from state_metrics.of_disks(self.services)
        yield from state_metrics.of_redis(self.services)

    def _database(self) -> Iterator[Metric]:
        """Yield the database's state; without it the other metrics tell the rest."""
        services, found = self.services, list[Metric]()
        try:
            with services.sessions.read() as session:
                found += state_metrics.of_database(session, services.settings.lease)
        except SQLAlchemyError:
            found = []
        yield gauge("database_up", "1 if the database answers.", (), [(bool(found),)])
        yield from found
        if isinstance(pool := services.sessions.engine.pool, QueuePool):
            used = [("in_use", pool.checkedout()), ("idle", pool.checkedin())]
            about = "Connections of the process that answers."
            yield gauge("database_connections", about, ("state",), used)
        limit = [(MAX_CONNECTIONS,)]
        yield gauge("database_connections_limit", "Most connections in use.", (), limit)

    def text(self) -> bytes:
        return generate_latest(self.registry)


def time_statements(engine: Engine, histogram: Histogram) -> None:
    """Have an engine observe the time of each statement."""

    def before(_connection: Any, _cursor: Any, _text: str, _values: Any, context: Any, _: Any):
        context.began = time.perf_counter()

    def after(_connection: Any, _cursor: Any, _text: str, _values: Any, context: Any, _: Any):
        histogram.observe(time.perf_counter() - context.began)

    event.listen(engine, "before_cursor_execute", before)
    event.listen(engine, "after_cursor_execute", after)


class CountRequests:
    """Middleware: count requests by route, since there is no limit on paths with ids."""

    def __init__(self, app: ASGIApp, metrics: Metrics):
        self.app, self.metrics = app, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        started = time.perf_counter()

        async def count_and_send(message: Message) -> None:
            if message["type"] == "http.response.start":
                spent = time.perf_counter() - started
                self.metrics.count(scope["method"], route(scope), message["status"], spent)
            await send(message)

        await self.app(scope, receive, count_and_send)


def route(scope: Scope) -> str:
    """Return the path with parameter names in place of their values."""
    path = scope["path"]
    given = sorted(scope.get("path_params", {}).items(), key=lambda p: -len(str(p[1])))
    if "endpoint" not in scope:
        return "none"
    if any(name == "path" for name, _ in given):
        return "page"
    for name, value in given:
        path = path.replace(f"/{value}", f"/{{{name}}}", 1)
    return path
