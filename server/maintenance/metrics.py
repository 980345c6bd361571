"""Metrics for Prometheus: runs, queues, workers and requests, without names or ids."""

import os
import time
from collections import Counter as Tally
from collections.abc import Iterable, Iterator
from pathlib import Path

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Histogram,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector
from redis import RedisError
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from microcosmos.version import VERSION

from ..core.processes import SHARED_METRICS
from ..services.services import Services
from ..storage import space
from ..tables import RUNNING, STATUSES, Run
from ..workers import registry

BUCKETS = (0.005, 0.02, 0.05, 0.1, 0.25, 1.0, 5.0)
"""Upper bounds of the histogram of request times, in seconds."""
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")

disable_created_metrics()


class Metrics(Collector):
    """Requests since the server started, and the state of database and queues.

    The processes of one server count requests together, in files.
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

    def count(self, method: str, route: str, status: int, seconds: float) -> None:
        method = method if method in METHODS else "other"  # Clients may invent some.
        self.requests.labels(method, route, status).inc()
        self.seconds.observe(seconds)

    def collect(self) -> Iterator[Metric]:
        yield InfoMetricFamily("microcosmos", "The server.", {"version": VERSION})
        with self.services.sessions.read() as session:
            yield from _runs(session)
            yield _workers(session, self.services.settings.lease)
        yield _disks(self.services)
        yield from _queues(self.services)

    def text(self) -> bytes:
        return generate_latest(self.registry)


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


def _runs(session: Session) -> Iterator[Metric]:
    sums = (func.sum(c) for c in (Run.evaluations, Run.infeasible, Run.generation, Run.seconds))
    each = session.execute(select(Run.status, func.count(), *sums).group_by(Run.status)).all()
    rows = {status: tuple(values) for status, *values in each}
    nothing = (0, 0, 0, 0, 0.0)
    counts = ((status, rows.get(status, nothing)[0]) for status in STATUSES)
    yield _gauge("runs", "Runs, by status.", ("status",), counts)
    for index, name, about in (
        (1, "evaluations", "Evaluations of all runs."),
        (2, "infeasible", "Infeasible evaluations."),
        (3, "generations", "Recorded generations."),
        (4, "computing_seconds", "Seconds of computing of all recorded generations."),
    ):
        total = sum(float(row[index]) for row in rows.values())
        yield CounterMetricFamily(f"microcosmos_{name}", about, total)
    _, _, _, generations, seconds = rows.get(RUNNING, nothing)
    mean = [(float(seconds) / float(generations),)] if generations else []
    yield _gauge("generation_seconds", "Mean seconds per generation of running runs.", (), mean)


def _workers(session: Session, lease: float) -> Metric:
    found = Tally((one.kind, one.status) for one in registry.live(session, lease))
    pairs = [(kind, status) for kind in ("cpu", "gpu") for status in ("idle", "busy")]
    counts = ((*pair, found[pair]) for pair in pairs)
    return _gauge("workers", "Live workers.", ("kind", "status"), counts)


def _disks(services: Services) -> Metric:
    """Label the disks by what they hold: paths may tell names."""
    settings, store = services.settings, services.artifacts
    kinds = {Path(store.root): "store", settings.data.resolve(): "database"}
    free = [(kinds[one], space.free_bytes(one)) for one in space.folders(settings, store)]
    return _gauge("disk_free_bytes", "Free bytes, by what the disk holds.", ("holds",), free)


def _queues(services: Services) -> Iterator[Metric]:
    try:
        lengths = services.jobs.lengths()
    except RedisError:
        lengths = {}
    yield _gauge("redis_up", "1 if Redis answers.", (), [(bool(lengths),)])
    yield _gauge("queue_length", "Jobs that wait for a worker.", ("queue",), lengths.items())


def _gauge(
    name: str, about: str, labels: Iterable[str], samples: Iterable[tuple[str | float, ...]]
) -> Metric:
    family = GaugeMetricFamily(f"microcosmos_{name}", about, labels=tuple(labels))
    for *values, value in samples:
        family.add_metric([str(one) for one in values], float(value))
    return family
