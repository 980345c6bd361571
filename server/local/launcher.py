"""What `make run` starts: Redis, server, workers, renderer and auditor, in one process tree."""

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from socket import AF_INET, AF_INET6, SO_REUSEADDR, SOL_SOCKET, socket
from subprocess import Popen

from sqlalchemy.exc import OperationalError

from ..auth import bootstrap
from ..core.folders import open_to_others, private
from ..core.processes import spawn
from ..services import services
from ..settings import Settings
from ..tables import migrations
from . import demonstration, locks, redis_embedded
from .process_tree import Child, Tree, say


class Cannot(RuntimeError):
    """Why it cannot start, for a person to read."""


@dataclass(frozen=True)
class Place:
    """A data folder, and what its processes find in their environment."""

    settings: Settings
    folder: Path
    environment: dict[str, str]

    def log(self, name: str) -> Path:
        return self.folder / "logs" / f"{name}.log"

    def module(self, name: str, *arguments: str) -> Callable[[], Popen[bytes]]:
        """What starts a Python module, its output in a log by this name."""
        command = [sys.executable, "-m", *arguments]
        return lambda: spawn(command, self.environment, self.log(name))


def occupy(settings: Settings) -> Place:
    """Take the data folder for as long as this process lives; nobody else may use it."""
    folder = settings.data.resolve()
    private(folder)
    if settings.needs_token and open_to_others(folder):
        say("warning", f"other users can look into {folder}: chmod o= {folder}")
    try:
        locks.take(folder / "lock")
    except locks.Held:
        raise Cannot(
            f"The data folder {folder} is in use by another Microcosmos: stop that one, "
            "or choose another folder with MICROCOSMOS_DATA."
        ) from None
    environment = {
        "JAX_COMPILATION_CACHE_DIR": str(folder / "jax-cache"),
        **os.environ,
        "MICROCOSMOS_DATA": str(folder),
    }
    return Place(settings, folder, environment)


def refuse_taken(host: str, port: int) -> None:
    with socket(AF_INET6 if ":" in host else AF_INET) as probe:
        probe.setsockopt(SOL_SOCKET, SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            raise Cannot(
                f"PORT must be one that is free on {host}; got {port} ({error.strerror}). "
                f"Choose another one, such as PORT={port + 1}."
            ) from None


def start(place: Place, tree: Tree) -> None:
    """Start everything, what others stand on first."""
    settings = start_redis(place, tree)
    if settings.needs_token:
        prepare_database(settings)  # The server begins only where there is a token.
    # The server brings the database up to date too; beside it, we need not wait for it.
    tree.children.append(Child("server", place.module("server", "server.main")))
    if not settings.needs_token:
        prepare_database(settings)
    for index in range(settings.workers):
        name = f"worker-{index}"
        tree.children.append(Child(name, place.module(name, "worker.supervisor", str(index))))
    for name in ("renderer", "auditor"):
        tree.children.append(Child(name, place.module(name, f"worker.{name}")))
    for child in tree.children:
        say(child.name, f"process {child.process.pid}, log in {place.log(child.name)}")


def prepare_database(settings: Settings) -> None:
    """Bring its tables up to date; a new one gets something to look at."""
    say("database", settings.database.rpartition("@")[2])  # Without a password.
    shared = services.connect(settings)
    try:
        migrations.upgrade(shared.sessions)
    except OperationalError as error:
        raise Cannot(
            f"The database {shared.sessions.engine.url!r} fails: {error.orig}"
        ) from None
    try:
        if secret := bootstrap.create_first_token(shared):
            say("token", bootstrap.announcement(settings, secret))
    except ValueError as error:
        raise Cannot(str(error)) from None
    if settings.demonstration:
        demonstration.offer(shared)
    shared.close()


def start_redis(place: Place, tree: Tree) -> Settings:
    """One of our own, unless the environment names one; the settings with its address."""
    if "redis_url" in place.settings.model_fields_set:
        say("redis", "the one that MICROCOSMOS_REDIS_URL names")
        return place.settings
    redis, log = redis_embedded.prepare(place.folder / "redis"), place.log("redis")
    child = Child("redis", lambda: redis.start(log))
    tree.ground.append(child)
    redis.wait(child.process, log)
    place.environment["MICROCOSMOS_REDIS_URL"] = redis.url
    say("redis", f"{redis.binary} on 127.0.0.1:{redis.port}")
    return place.settings.model_copy(update={"redis_url": redis.url})


def answers(settings: Settings) -> bool:
    """Whether the server does."""
    connection = HTTPConnection(settings.host, settings.port, timeout=1)
    with suppress(OSError, HTTPException):
        connection.request("GET", "/healthz")
        return connection.getresponse().status == 200
    return False


def main() -> None:
    """Run until Ctrl-C; what was started ends with us and nothing is lost."""
    try:
        settings = Settings()
    except ValueError as error:
        sys.exit(str(error))
    address = f"http://{settings.host}:{settings.port}"
    tree = Tree()
    tree.listen()
    try:
        place = occupy(settings)
        refuse_taken(settings.host, settings.port)
        say("starting", address)
        start(place, tree)
        tree.watch(lambda: answers(settings))
        if not tree.asked:
            say("ready", f"{address} (Ctrl-C ends it)")
        tree.watch()
        say("ending", "runs are checkpointed and go on at the next start")
    except (Cannot, redis_embedded.RedisError) as error:
        sys.exit(str(error))
    finally:
        tree.end()
