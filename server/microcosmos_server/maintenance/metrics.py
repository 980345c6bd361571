"""Metrics for Prometheus: requests and statements of this server, and the installation's state.

Labels are bounded: `run` names running runs, of which a worker has one; `gpu` names cards of
live workers; `host` names hosts of live workers, and at most `totals.MAX_HOSTS` others.
"""

import os
import shutil
import time
from collections import Counter as Tally
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

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
from sqlalchemy import Engine, QueuePool, event, func, select
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from microcosmos.version import VERSION

from ..core.database import MAX_CONNECTIONS, now
from ..core.processes import SHARED_METRICS
from ..notifications import outbox
from ..schedule import fit
from ..services.services import Services
from ..storage import space
from ..tables import (
    CHECKPOINT,
    PAUSED,
    RUNNING,
    STATUSES,
    TERMINAL,
    Artifact,
    InstallationState,
    Run,
    Worker,
)
from ..workers import registry, totals
from ..workers.totals import Key

Samples = Iterable[tuple[str | float, ...]]
"""Values of the labels, then the value."""


def gauge(name: str, about: str, labels: Iterable[str], samples: Samples) -> Metric:
    family = GaugeMetricFamily(f"microcosmos_{name}", about, labels=tuple(labels))
    return _filled(family, samples)


def counter(name: str, about: str, labels: Iterable[str], samples: Samples) -> Metric:
    family = CounterMetricFamily(f"microcosmos_{name}", about, labels=tuple(labels))
    return _filled(family, samples)


def _filled(family: Any, samples: Samples) -> Metric:
    for *values, value in samples:
        family.add_metric([str(one) for one in values], float(value))
    return family


def of_database(session: Session, lease: float) -> Iterator[Metric]:
    """Yield the metrics that are read from the database."""
    alive = registry.live(session, lease)
    yield from _passes(session)
    yield from _runs(session)
    yield _checkpoints(session)
    yield _unfit(session, alive)
    yield from _workers(alive)
    yield from _gpus(alive)
    yield from _totals(session)
    yield from _by_host(session, {totals.host_of(one.name) for one in alive})
    count, oldest = outbox.waiting(session)
    yield gauge("webhook_waiting", "Notifications that wait.", (), [(count,)])
    yield gauge("webhook_oldest_seconds", "Age of the oldest of them.", (), [(oldest,)])


def _passes(session: Session) -> Iterator[Metric]:
    passed = select(InstallationState.passed_at, InstallationState.pass_seconds)
    at, seconds = session.execute(passed).one()
    age = [((now(session) - at).total_seconds(),)] if at else []
    about = "Seconds since the reconciler last completed a pass."
    yield gauge("reconciler_pass_age_seconds", about, (), age)
    took = [(seconds,)] if seconds is not None else []
    yield gauge("reconciler_pass_seconds", "Seconds that this pass took.", (), took)


def _runs(session: Session) -> Iterator[Metric]:
    counts = select(Run.status, func.count()).group_by(Run.status)
    found = {status: number for status, number in session.execute(counts)}
    samples = [(status, found.get(status, 0)) for status in STATUSES]
    yield gauge("runs", "Runs, by status.", ("status",), samples)
    stuck = (Run.status == PAUSED, Run.warning.is_not(None), Run.deleted_at.is_(None))
    needed = session.scalar(select(func.count()).select_from(Run).where(*stuck)) or 0
    yield gauge("runs_need_person", "Paused runs with a warning.", (), [(needed,)])
    sums = select(func.sum(Run.seconds), func.sum(Run.generation)).where(Run.status == RUNNING)
    seconds, generations = session.execute(sums).one()
    mean = [(float(seconds) / float(generations),)] if generations else []
    yield gauge("generation_seconds", "Mean seconds per generation of running runs.", (), mean)


def _checkpoints(session: Session) -> Metric:
    """Measure ages by the clock of the database, with which the times were written."""
    mine = (Artifact.run_id == Run.id) & (Artifact.kind == CHECKPOINT)
    newest = func.coalesce(func.max(Artifact.created_at), Run.started_at)
    running = select(Run.id, newest).outerjoin(Artifact, mine).where(Run.status == RUNNING)
    moment = now(session)
    samples = [
        (str(run), (moment - at).total_seconds())
        for run, at in session.execute(running.group_by(Run.id, Run.started_at))
        if at is not None
    ]
    about = "Age of the last checkpoint of a running run; without one, since its start."
    return gauge("run_checkpoint_age_seconds", about, ("run",), samples)


def _unfit(session: Session, alive: Sequence[Worker]) -> Metric:
    found = fit.count_unfit(session, alive, now(session))
    reasons = ("worker", *(one.name for one in fit.REQUIREMENTS))
    samples = [(reason, found[reason]) for reason in reasons]
    about = "Queued runs that no live worker can compute, by what is missing."
    return gauge("runs_unfit", about, ("missing",), samples)


def _workers(alive: Sequence[Worker]) -> Iterator[Metric]:
    found = Tally((one.kind, registry.state(one)) for one in alive)
    pairs = [(kind, state) for kind in ("cpu", "gpu") for state in registry.STATES]
    samples = [(*pair, found[pair]) for pair in pairs]
    yield gauge("workers", "Live workers.", ("kind", "status"), samples)
    problems = Tally(
        (totals.host_of(one.name), one.problem_kind) for one in alive if one.problem_kind
    )
    about = "Live workers that take no run, by host and problem."
    samples = [(*pair, number) for pair, number in sorted(problems.items())]
    yield gauge("worker_problems", about, ("host", "problem"), samples)


def _gpus(alive: Sequence[Worker]) -> Iterator[Metric]:
    cards = {(totals.host_of(one.name), one.gpu["uuid"]): one.gpu for one in alive if one.gpu}
    yield gauge(
        "gpu_temperature_celsius",
        "Temperature of a card.",
        ("host", "gpu"),
        _known(cards, "temperature_celsius"),
    )
    yield counter(
        "gpu_ecc_errors",
        "Memory errors in a card's lifetime that could not be corrected.",
        ("host", "gpu"),
        _known(cards, "ecc_errors"),
    )


def _known(cards: Mapping[tuple[str, str], Mapping[str, Any]], name: str) -> Samples:
    return [(*key, card[name]) for key, card in cards.items() if card[name] is not None]


def _totals(session: Session) -> Iterator[Metric]:
    found = totals.read(session)
    for key, about in (
        (totals.EVALUATIONS, "Evaluations."),
        (totals.INFEASIBLE, "Infeasible evaluations."),
        (totals.GENERATIONS, "Recorded generations."),
        (totals.COMPUTING_SECONDS, "Seconds of computing of all recorded generations."),
    ):
        yield counter(key.name, about, (), [(found.get(key, 0.0),)])
    ended = [(one, found.get(Key(totals.RUNS_ENDED, one), 0.0)) for one in (*TERMINAL, PAUSED)]
    about = "Runs that ended, or paused until a person acts."
    yield counter("runs_ended", about, ("status",), ended)
    tries = [(key.kind, found.get(key, 0.0)) for key in outbox.OUTCOMES]
    yield counter("webhook_tries", "Notifications sent, by outcome.", ("outcome",), tries)


def _by_host(session: Session, hosts: set[str]) -> Iterator[Metric]:
    """Yield totals by host; those of a new host begin at 0, so that each rise is seen."""
    found = totals.read_by_host(session, hosts)
    for key, name, about in (
        (totals.ATTEMPTS, "attempts", "Attempts that began."),
        (totals.CHECKPOINT_FAILURES, "checkpoint_failures", "Failed writes of checkpoints."),
        (totals.XID_ERRORS, "gpu_xid_errors", "Errors that the driver of a GPU reported."),
    ):
        samples = [(host, counts.get(key, 0.0)) for host, counts in found.items()]
        yield counter(name, about, ("host",), samples)
    samples = [
        (host, reason, counts.get(key, 0.0))
        for host, counts in found.items()
        for reason, key in totals.FAILURES.items()
    ]
    about = "Attempts that failed."
    yield counter("attempt_failures", about, ("host", "reason"), samples)


def of_disks(services: Services) -> Iterator[Metric]:
    """Yield the space of disks, labelled by what they hold: paths may contain names."""
    settings = services.settings
    folders = space.folders(settings, services.artifacts)
    free = [(kind, space.free_bytes(one)) for kind, one in folders.items()]
    yield gauge("disk_free_bytes", "Free bytes, by what the disk holds.", ("holds",), free)
    whole = [
        (kind, shutil.disk_usage(one).total) for kind, one in folders.items() if one.exists()
    ]
    yield gauge("disk_size_bytes", "Size of that disk.", ("holds",), whole)
    needed = [(settings.min_free_bytes,)]
    yield gauge("disk_needed_bytes", "Free bytes below which the server warns.", (), needed)


def of_redis(services: Services) -> Iterator[Metric]:
    try:
        lengths = services.jobs.lengths()
    except RedisError:
        lengths = {}
    yield gauge("redis_up", "1 if Redis answers.", (), [(bool(lengths),)])
    yield gauge("queue_length", "Jobs that wait for a worker.", ("queue",), lengths.items())


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
        yield from of_disks(self.services)
        yield from of_redis(self.services)

    def _database(self) -> Iterator[Metric]:
        """Yield the metrics of the database; without it the other metrics remain."""
        services, found = self.services, list[Metric]()
        try:
            with services.sessions.read() as session:
                found += of_database(session, services.settings.lease)
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
    """Return the template of the matched route: clients choose paths, and so their number."""
    matched = scope.get("route")
    if matched is None:
        return "none"
    if "path" in scope["path_params"]:
        return "page"
    return ("/api/v1" if scope["path"].startswith("/api/v1/") else "") + matched.path
