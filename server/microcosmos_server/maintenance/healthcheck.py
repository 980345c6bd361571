"""`python -m microcosmos_server.maintenance.healthcheck PART [--restart]`: check one part.

For a container's health check: the exit status is 0 for a healthy part. Docker does not restart
unhealthy containers, so `--restart` ends a part that has failed for minutes. The restart policy
starts it again. A part that only waits for the database or for Redis is left alone.
"""

import socket
import sys
import tempfile
import time
from contextlib import closing
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from urllib.parse import urlsplit

import psutil
from redis import RedisError
from rq.worker import Worker
from sqlalchemy import select
from sqlalchemy.exc import SQLAlchemyError

from ..services.services import Services, connect
from ..settings import Settings, from_environment
from ..tables import InstallationState
from ..workers import registry

PARTS = ("server", "worker", "renderer", "auditor")
INITS = ("docker-init", "tini", "catatonit")
"""Names of a container's first process with `init: true`."""
TERMINATE_AFTER, KILL_AFTER = 180.0, 240.0
"""Seconds of failed checks in a row."""


def alive(services: Services, part: str, host: str) -> bool:
    """Return whether a process of this kind on a host has reported within its lease.

    Workers report to the database, renderer and auditor to Redis, which forgets silent ones.
    """
    if part == "worker":
        with services.sessions.write.begin() as session:
            # To a database that is read-only no worker can report: this raises there, too.
            session.execute(select(InstallationState.id).with_for_update())
            names = [found.name for found in registry.live(session, services.settings.lease)]
        return any(name.rpartition("-")[0] == host for name in names)
    keys = Worker.redis_worker_namespace_prefix + f"{part}-{host}-*"
    return any(True for _ in services.redis.scan_iter(keys))


def answers(url: str) -> bool:
    """Return whether the server answers a request with 200."""
    address = urlsplit(url)
    try:
        with closing(HTTPConnection(address.hostname or "", address.port, timeout=5)) as opened:
            opened.request("GET", address.path)
            return opened.getresponse().status == 200
    except (OSError, HTTPException):
        return False


def fault(settings: Settings, part: str) -> str:
    """Return the fault of a part; empty for a healthy one.

    Raise `ConnectionError` if the database or Redis cannot be reached.
    """
    if part == "server":
        if not answers(f"{settings.address}/healthz"):
            return "The server does not answer."
        if not answers(f"{settings.address}/readyz"):
            raise ConnectionError("The server cannot reach the database, Redis or its store.")
        return ""
    services = connect(settings)
    host = socket.gethostname()
    try:
        return "" if alive(services, part, host) else f"No {part} on {host} has reported."
    except (SQLAlchemyError, RedisError) as error:
        raise ConnectionError(f"The database or Redis cannot be reached: {error}") from None
    finally:
        services.close()


def end_failing(mark: Path, init: int = 1) -> None:
    """End the program of a container once its check has failed for minutes.

    `mark` is a file as old as the first failure; `init` is the container's first process.
    """
    process = psutil.Process(init)
    if process.name() not in INITS:
        return  # Not in a container: nothing would start it again.
    if not mark.exists():
        mark.touch()
    failing = time.time() - mark.stat().st_mtime
    if failing >= TERMINATE_AFTER:
        for child in process.children():
            child.terminate() if failing < KILL_AFTER else child.kill()


def main(arguments: list[str]) -> None:
    part, *options = arguments or [""]
    if part not in PARTS or options not in ([], ["--restart"]):
        sys.exit(f"One part is needed, of {', '.join(PARTS)}; got {' '.join(arguments)!r}")
    mark = Path(tempfile.gettempdir()) / f"microcosmos-{part}-fails"
    try:
        found = fault(from_environment(), part)
    except ConnectionError as error:
        mark.unlink(missing_ok=True)
        sys.exit(str(error))
    if found and options:
        end_failing(mark)
    elif not found:
        mark.unlink(missing_ok=True)
    if found:
        sys.exit(found)


if __name__ == "__main__":
    main(sys.argv[1:])
