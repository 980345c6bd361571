"""`make run`: Redis, server, workers, renderer and auditor in one process tree."""

import os
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from socket import AF_INET, AF_INET6, SO_REUSEADDR, SOL_SOCKET, socket
from stat import S_IRWXO
from subprocess import Popen

from filelock import FileLock, Timeout
from sqlalchemy import exists, select
from sqlalchemy.exc import OperationalError

from microcosmos.spec import EXPERIMENTS

from ..auth import bootstrap
from ..core.processes import python, start_logged
from ..maintenance.healthcheck import answers
from ..runs.submission import submit
from ..services import services
from ..settings import Settings, create_data_folder, from_environment
from ..tables import Run, migrations
from . import redis_embedded
from .process_tree import Child, Tree, say


class StartError(RuntimeError):
    """Microcosmos cannot start; the message says why."""


@dataclass(frozen=True)
class DataFolder:
    """A data folder, locked for this process, and the environment of its processes."""

    settings: Settings
    folder: Path
    environment: dict[str, str]
    lock: FileLock

    def log(self, name: str) -> Path:
        return self.folder / "logs" / f"{name}.log"

    def module(self, name: str, *arguments: str) -> Callable[[], Popen[bytes]]:
        """Return a function that starts a Python module, its output in a log of this name."""
        command = python(*arguments)
        return lambda: start_logged(command, self.environment, self.log(name))


def lock_data_folder(settings: Settings) -> DataFolder:
    """Lock the data folder for as long as this process lives."""
    folder = settings.data.resolve()
    create_data_folder(settings)
    if settings.needs_token and folder.stat().st_mode & S_IRWXO:
        say("warning", f"other users can look into {folder}: chmod o= {folder}")
    lock = FileLock(folder / "lock", mode=0o600)
    try:
        lock.acquire(timeout=0)
    except Timeout:
        raise StartError(
            f"The data folder {folder} is in use by another Microcosmos: stop that one, "
            "or choose another folder with MICROCOSMOS_DATA."
        ) from None
    environment = {
        "JAX_COMPILATION_CACHE_DIR": str(folder / "jax-cache"),
        **os.environ,
        "MICROCOSMOS_DATA": str(folder),
    }
    return DataFolder(settings, folder, environment, lock)


def refuse_port_in_use(host: str, port: int) -> None:
    with socket(AF_INET6 if ":" in host else AF_INET) as probe:
        probe.setsockopt(SOL_SOCKET, SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise StartError(
                f"PORT must be one that is free on {host}; got {port} ({error.strerror}). "
                f"Choose another one, such as PORT={port + 1}."
            ) from None


def start(data: DataFolder, tree: Tree) -> None:
    """Start the server and the workers, first what they depend on."""
    settings = start_redis(data, tree)
    if settings.needs_token:
        prepare_database(settings)  # The server refuses to start without a token.
    # The server migrates the database too; both may do it at once.
    start_child(data, tree, "server", "microcosmos_server.main")
    if not settings.needs_token:
        prepare_database(settings)
    for index in range(settings.workers):
        start_child(data, tree, f"worker-{index}", "microcosmos_worker.supervisor", str(index))


def start_renderer_and_auditor(data: DataFolder, tree: Tree) -> None:
    """Start these last: a new page does not need them, and the others need the CPU cores."""
    for name in ("renderer", "auditor"):
        start_child(data, tree, name, "microcosmos_worker.renderer", name)


def start_child(data: DataFolder, tree: Tree, name: str, *module: str) -> None:
    child = Child(name, data.module(name, *module))
    tree.children.append(child)
    say(name, f"process {child.process.pid}, log in {data.log(name)}")


def prepare_database(settings: Settings) -> None:
    """Migrate the database; submit the demonstration run to a new one."""
    url = settings.database
    say("database", f"{url.host}/{url.database}" if url.host else f"{url.database}")
    shared = services.connect(settings)
    try:
        migrations.upgrade(shared.sessions)
    except OperationalError as error:
        raise StartError(
            f"The database {shared.sessions.engine.url!r} fails: {error.orig}"
        ) from None
    except migrations.SchemaError as error:
        raise StartError(str(error)) from None
    try:
        if secret := bootstrap.create_first_token(shared):
            say("token", bootstrap.announcement(settings, secret))
    except ValueError as error:
        raise StartError(str(error)) from None
    with shared.sessions.read() as session:
        new = not session.scalar(select(exists().select_from(Run)))
    if settings.demonstration and new:
        presets = {one.name: one.spec for one in EXPERIMENTS["quality-diversity"].presets}
        submit(shared, presets["demo"], demonstration=True)
    shared.close()


def start_redis(data: DataFolder, tree: Tree) -> Settings:
    """Start a Redis, unless the settings name one; return the settings with its address."""
    if "redis_url" in data.settings.model_fields_set:
        say("redis", "the one that MICROCOSMOS_REDIS_URL names")
        return data.settings
    redis, log = redis_embedded.prepare(data.folder / "redis"), data.log("redis")
    child = Child("redis", lambda: redis.start(log))
    tree.services.append(child)
    redis.wait(child.process, log)
    data.environment["MICROCOSMOS_REDIS_URL"] = redis.url
    say("redis", f"{redis.binary} on 127.0.0.1:{redis.port}")
    return data.settings.model_copy(update={"redis_url": redis.url})


def rotate_logs(data: DataFolder) -> None:
    rotate(data.folder / "logs", data.settings.log_bytes)


def main() -> None:
    """Run until Ctrl-C; all processes end with this one."""
    settings = from_environment()
    address = settings.address
    tree = Tree()
    tree.handle_signals()
    try:
        data = lock_data_folder(settings)
        refuse_port_in_use(settings.host, settings.port)
        tree.upkeep = partial(rotate_logs, data)
        say("starting", address)
        start(data, tree)
        tree.watch(lambda: answers(f"{address}/healthz"))
        if not tree.stop_requested:
            start_renderer_and_auditor(data, tree)
            say("ready", f"{address} (Ctrl-C ends it)")
        tree.watch()
        say("ending", "runs are checkpointed and continue at the next start")
    except (StartError, redis_embedded.RedisError) as error:
        sys.exit(str(error))
    finally:
        tree.end()


# Processes hold their logs open and append to them, Redis too, so a log keeps its name.
OLDER_PARTS = 4
"""Number of older parts of each log: `server.log.1` is the newest."""


def rotate(folder: Path, limit: int) -> None:
    """Rotate the logs in a folder that are longer than `limit` bytes."""
    for log in sorted(folder.glob("*.log")):
        try:
            if log.stat().st_size > limit:
                _rotate(log)
        except OSError as error:  # The disk may be full.
            say("logs", f"{log.name} cannot be rotated and keeps growing: {error}")


def _rotate(log: Path) -> None:
    parts = [log.with_name(f"{log.name}.{number}") for number in range(1, OLDER_PARTS + 1)]
    part = log.with_name(f"{log.name}.part")
    try:
        shutil.copyfile(log, part)
    except OSError:
        part.unlink(missing_ok=True)
        raise
    for older, newer in zip(reversed(parts), reversed(parts[:-1]), strict=False):
        if newer.exists():
            newer.replace(older)
    part.replace(parts[0])
    os.truncate(log, 0)
