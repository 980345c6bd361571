"""Health report: the state of the database, disk, Redis, queues and workers."""

import shutil
import time
from contextlib import suppress
from pathlib import Path
from urllib.parse import urlsplit
from uuid import uuid4

import psutil
from redis import RedisError
from sqlalchemy import func, select, text
from sqlalchemy.exc import SQLAlchemyError

from microcosmos.version import VERSION

from ..core.schemas import Wire
from ..services.services import Services
from ..storage import mark
from ..tables import QUEUED, Run, migrations
from ..workers import registry

PROBE = bytes(4096)


class DatabaseHealth(Wire):
    """The database, and the migration that its tables have."""

    dialect: str
    version: str | None
    location: str
    """Host and database, or the file; never a password."""
    reachable: bool
    error: str | None
    revision: str | None
    """None before the first start."""
    newest_revision: str
    """The revision that this version of the server knows as the last one."""


class DiskHealth(Wire):
    """The store of checkpoints and renderings."""

    location: str
    free_bytes: int | None
    """None where the store is not a folder of this machine, as `total_bytes`."""
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


def disk(services: Services) -> DiskHealth:
    """Write a small file to the store and delete it."""
    store = services.artifacts
    path, seconds, error = f"probe-{uuid4().hex}", None, None
    started = time.monotonic()
    try:
        store.write(path, PROBE)
        seconds = time.monotonic() - started
        store.delete(path)
    except OSError as failed:
        error = str(failed)
    with suppress(SQLAlchemyError):  # The report says so elsewhere.
        error = error or mark.fault(services.sessions, store)
    folder = Path(store.root) if store.local else None
    there = folder and next(one for one in (folder, *folder.parents) if one.exists())
    usage = there and shutil.disk_usage(there)
    return DiskHealth(
        location=store.location,
        free_bytes=usage.free if usage else None,
        total_bytes=usage.total if usage else None,
        file_system=_file_system(there) if there else "s3",
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
