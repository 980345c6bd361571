"""What Prometheus is told: runs, queues, workers and requests, as numbers without names."""

import threading
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from redis import RedisError
from sqlalchemy import func, select
from sqlalchemy.orm import Session
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from microcosmos.version import VERSION

from ..services.services import Services
from ..tables import RUNNING, STATUSES, Run
from ..workers import registry

BUCKETS = (0.005, 0.02, 0.05, 0.1, 0.25, 1.0, 5.0)
"""Seconds of requests, the last bucket aside, which is for the longest."""
QUEUES = ("runs", "sweeps", "renderings", "audits")
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
ESCAPES = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n"})

Labels = Mapping[str, str]
Sample = tuple[str, Labels, float]
"""What is added to the name of its family, labels, and a value."""


@dataclass(frozen=True)
class Family:
    """Samples of one thing, in Prometheus' text format when written."""

    name: str
    kind: Literal["counter", "gauge", "histogram"]
    about: str
    samples: Iterable[Sample]

    def lines(self) -> Iterator[str]:
        name = f"microcosmos_{self.name}"
        yield f"# HELP {name} {self.about}"
        yield f"# TYPE {name} {self.kind}"
        for suffix, labels, value in self.samples:
            pairs = ",".join(f'{k}="{v.translate(ESCAPES)}"' for k, v in labels.items())
            yield f"{name}{suffix}{'{' + pairs + '}' if pairs else ''} {value:.16g}"


@dataclass
class Requests:
    """Requests of this process since it began, by route and outcome; one lock for all."""

    counts: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    """By method, route and status."""
    within: Counter[float] = field(default_factory=Counter)
    """How many took no longer than a bucket says, of those that no shorter one holds."""
    seconds: float = 0.0
    lock: threading.Lock = field(default_factory=threading.Lock)

    def add(self, method: str, route: str, status: int, seconds: float) -> None:
        method = method if method in METHODS else "other"  # Strangers may invent some.
        bucket = next((limit for limit in BUCKETS if seconds <= limit), float("inf"))
        with self.lock:
            self.counts[method, route, str(status)] += 1
            self.within[bucket] += 1
            self.seconds += seconds

    def families(self) -> list[Family]:
        with self.lock:
            counts, within, seconds = dict(self.counts), dict(self.within), self.seconds
        by: list[Sample] = [
            ("", {"method": method, "route": route, "status": status}, count)
            for (method, route, status), count in sorted(counts.items())
        ]
        return [
            Family("requests_total", "counter", "Requests that were answered.", by),
            Family(
                "request_seconds",
                "histogram",
                "Seconds from a request to the beginning of its answer.",
                _histogram(within, seconds),
            ),
        ]


def _histogram(within: Mapping[float, int], seconds: float) -> Iterator[Sample]:
    total = 0
    for limit in (*BUCKETS, float("inf")):
        total += within.get(limit, 0)
        yield "_bucket", {"le": "+Inf" if limit == float("inf") else f"{limit:g}"}, total
    yield "_sum", {}, seconds
    yield "_count", {}, total


class Counting:
    """Counts requests, each by its route: addresses with names in them are without number."""

    def __init__(self, app: ASGIApp, requests: Requests):
        self.app, self.requests = app, requests

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        began = time.perf_counter()

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                spent = time.perf_counter() - began
                self.requests.add(scope["method"], route(scope), message["status"], spent)
            await send(message)

        await self.app(scope, receive, sent)


def route(scope: Scope) -> str:
    """The address with the names of what it is about in place of their values."""
    path = scope["path"]
    given = sorted(scope.get("path_params", {}).items(), key=lambda p: -len(str(p[1])))
    if "endpoint" not in scope:
        return "none"
    if any(name == "path" for name, _ in given):
        return "page"
    for name, value in given:
        path = path.replace(f"/{value}", f"/{{{name}}}", 1)
    return path


def measured(services: Services) -> Iterator[Family]:
    """What database and queues tell now."""
    yield Family("info", "gauge", "The server.", [("", {"version": VERSION}, 1)])
    with services.sessions.read() as session:
        yield from _runs(session)
        yield _workers(session, services.settings.lease)
    yield from _queues(services)


def _runs(session: Session) -> Iterator[Family]:
    sums = (func.sum(c) for c in (Run.evaluations, Run.diverged, Run.generation, Run.seconds))
    each = session.execute(select(Run.status, func.count(), *sums).group_by(Run.status)).all()
    rows = {status: tuple(values) for status, *values in each}
    nothing = (0, 0, 0, 0, 0.0)
    by = [("", {"status": status}, rows.get(status, nothing)[0]) for status in STATUSES]
    yield Family("runs", "gauge", "Runs, by status.", by)
    totals = [sum(float(row[i]) for row in rows.values()) for i in range(5)]
    for index, name, about in (
        (1, "evaluations_total", "Creatures that were simulated, in all runs there are."),
        (2, "diverged_total", "Simulations that did not stay finite."),
        (3, "generations_total", "Generations that were recorded."),
        (4, "computing_seconds_total", "Seconds of computing that led to a record."),
    ):
        yield Family(name, "counter", about, [("", {}, totals[index])])
    _, _, _, generations, seconds = rows.get(RUNNING, nothing)
    mean = [("", {}, float(seconds) / float(generations))] if generations else []
    yield Family(
        "generation_seconds", "gauge", "Mean seconds a generation of running runs.", mean
    )


def _workers(session: Session, lease: float) -> Family:
    found = Counter((one.kind, one.status) for one in registry.live(session, lease))
    kinds = [(kind, status) for kind in ("cpu", "gpu") for status in ("idle", "busy")]
    by = [("", {"kind": k, "status": s}, found[k, s]) for k, s in kinds]
    return Family("workers", "gauge", "Workers that were heard of in time.", by)


def _queues(services: Services) -> Iterator[Family]:
    jobs = services.jobs
    lengths: dict[str, int] = dict.fromkeys(QUEUES, 0)
    try:
        for queue in (*jobs.evolving_anywhere(), jobs.renderings, jobs.audits):
            kind = next(one for one in QUEUES if queue.name.startswith(getattr(jobs, one).name))
            lengths[kind] += len(queue)
        by = [("", {"queue": name}, length) for name, length in lengths.items()]
    except RedisError:
        by = []
    yield Family("redis_up", "gauge", "Whether Redis answers.", [("", {}, bool(by))])
    yield Family("queue_length", "gauge", "Messages that wait to be taken.", by)
