"""Routes of liveness, readiness and metrics, and the health report of all parts."""

import shutil
import time
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import Literal
from urllib.parse import urlsplit

import psutil
from fastapi import APIRouter, Request, Response
from fastapi.responses import PlainTextResponse
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from redis import RedisError
from sqlalchemy import func, select, text
from sqlalchemy.exc import SQLAlchemyError

from microcosmos.version import VERSION

from ..auth.authorize import MAY_ADMINISTER, MAY_READ, PUBLIC
from ..core import static_files
from ..core.schemas import Wire
from ..services.services import Services, ServicesDep
from ..settings import existing
from ..storage import mark, space
from ..storage.artifacts import Artifacts
from ..tables import QUEUED, Run, migrations
from ..workers import registry

PROBE_PATH, PROBE = "probe", bytes(4096)


class DatabaseHealth(Wire):
    """The database, and the migration that its tables have."""

    dialect: str
    version: str | None
    location: str
    """Host and database, or the file; never a password."""
    reachable: bool
    error: str | None
    revision: str | None
    """The migration of the tables; None before the first start."""
    newest_revision: str
    """The revision that this version of the server knows as the last one."""


class DiskHealth(Wire):
    """The store of checkpoints and renderings."""

    location: str
    free_bytes: int | None
    """Both are None where the store is not a folder of this machine."""
    total_bytes: int | None
    file_system: str | None
    """`s3` for an object store, which has no disk."""
    writable: bool
    write_seconds: float | None
    """Seconds that 4096 bytes took to reach the disk."""
    error: str | None


class RedisHealth(Wire):
    location: str
    reachable: bool
    error: str | None
    version: str | None
    policy: str | None
    """`maxmemory-policy`; with any but `noeviction` a full Redis drops jobs."""


class HealthReport(Wire):
    version: str
    database: DatabaseHealth
    disk: DiskHealth
    redis: RedisHealth
    queues: dict[str, int]
    """Jobs that wait, by queue; empty where Redis does not answer."""
    workers: dict[str, int]
    """Live workers, `idle`, `busy` or with a `problem`; empty without the database."""


def database(services: Services) -> DatabaseHealth:
    engine = services.sessions.engine
    url = engine.url
    revision, version, error = None, None, None
    try:
        revision = migrations.revision(services.sessions)
        with services.sessions.read() as session:
            found = "sqlite_version()" if url.get_backend_name() == "sqlite" else "version()"
            version = session.execute(text(f"SELECT {found}")).scalar_one()
    except SQLAlchemyError as failed:
        error = str(getattr(failed, "orig", None) or failed)
    return DatabaseHealth(
        dialect=url.get_backend_name(),
        version=version,
        location=f"{url.host or ''}{'/' if url.host else ''}{url.database or ''}",
        reachable=error is None,
        error=error,
        revision=revision,
        newest_revision=migrations.newest(),
    )


def probe(store: Artifacts) -> float:
    """Write a small file to the store and delete it; return how many seconds the writing took.

    Raise `OSError` if the store takes none.
    """
    started = time.monotonic()
    store.write(PROBE_PATH, PROBE)
    seconds = time.monotonic() - started
    store.delete(PROBE_PATH)
    return seconds


def disk(services: Services) -> DiskHealth:
    store, seconds, error = services.artifacts, None, None
    try:
        seconds = probe(store)
    except OSError as failed:
        error = str(failed)
    with suppress(SQLAlchemyError):  # The report says so elsewhere.
        error = error or mark.fault(services.sessions, store)
    folder = existing(Path(store.root)) if store.local else None
    usage = folder and shutil.disk_usage(folder)
    return DiskHealth(
        location=store.location,
        free_bytes=usage.free if usage else None,
        total_bytes=usage.total if usage else None,
        file_system=_file_system(folder) if folder else "s3",
        writable=error is None,
        write_seconds=seconds,
        error=error,
    )


def _file_system(folder: Path) -> str | None:
    holding = [
        mount
        for mount in psutil.disk_partitions(all=True)
        if folder.resolve().is_relative_to(mount.mountpoint)
    ]
    nearest = max(holding, key=lambda mount: len(mount.mountpoint), default=None)
    return nearest.fstype if nearest else None


def redis(services: Services) -> RedisHealth:
    address = urlsplit(services.settings.redis_url)
    info, error = {}, None
    try:
        info = dict(services.redis.info())  # pyright: ignore
    except RedisError as failed:
        error = str(failed)
    return RedisHealth(
        location=f"{address.hostname or address.path}:{address.port or 6379}",
        reachable=error is None,
        error=error,
        version=info.get("redis_version"),
        policy=info.get("maxmemory_policy"),
    )


def report(services: Services) -> HealthReport:
    found, messages = database(services), redis(services)
    workers: dict[str, int] = {}
    queues: dict[str, int] = services.jobs.lengths() if messages.reachable else {}
    if found.reachable:
        with services.sessions.read() as session:
            live = registry.live(session, services.settings.lease)
            runs = session.scalar(select(func.count()).where(Run.status == QUEUED)) or 0
        workers = {status: 0 for status in registry.STATES}
        for one in live:
            workers[registry.state(one)] += 1
        queues["runs"] = runs
    return HealthReport(
        version=VERSION,
        database=found,
        disk=disk(services),
        redis=messages,
        queues=queues,
        workers=workers,
    )


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
    database: Literal["ok", "unreachable", "of another version"]
    redis: Answer
    store: Literal["ok", "wrong or unreachable", "cannot be written"]
    disk: Literal["ok", "almost full", "full", "none"]
    """`almost full` is a warning: the server is ready all the same. `none`: files are in an
    object store and rows in PostgreSQL, whose disks this machine does not see."""


@router.get("/health", dependencies=[MAY_ADMINISTER])
def read_health(services: ServicesDep) -> HealthReport:
    """Return the state of the database, the disk, Redis, the queues and the workers."""
    return report(services)


@outside.get("/healthz", dependencies=[PUBLIC])
async def alive() -> Health:
    """Answer without a thread: all may be waiting for something else."""
    return Health(help=static_files.DOCUMENTATION.is_dir())


WRITTEN_SECONDS = 10.0
"""Seconds between two looks at whether the store can be written: anybody may ask."""


class Writable:
    """Tells whether the store can be written, by writing to it from time to time."""

    def __init__(self, store: Artifacts):
        self._store, self._due, self._good = store, 0.0, True
        self._looking = Lock()

    def __call__(self) -> bool:
        # One request at a time looks; others take what the last one found.
        if time.monotonic() >= self._due and self._looking.acquire(blocking=False):
            try:
                probe(self._store)
                self._good = True
            except OSError:
                self._good = False
            finally:
                self._due = time.monotonic() + WRITTEN_SECONDS
                self._looking.release()
        return self._good


@outside.get("/readyz", responses={503: {"model": Readiness}}, dependencies=[PUBLIC])
def ready(services: ServicesDep, request: Request, response: Response) -> Readiness:
    found = Readiness(database="ok", redis="ok", store="ok", disk="ok")
    if not space.folders(services.settings, services.artifacts):
        found.disk = "none"
    if space.shortage(services.settings, services.artifacts):
        full = space.is_full(services.settings, services.artifacts)
        found.disk = "full" if full else "almost full"
    try:
        if migrations.fault(services.sessions):
            found.database = "of another version"
        if mark.fault(services.sessions, services.artifacts):
            found.store = "wrong or unreachable"
        elif not request.app.state.writable():
            found.store = "cannot be written"
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
