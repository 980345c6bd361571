"""`python -m worker.health worker|renderer|auditor`: whether this machine's own is alive.

For a container's health check: its exit status is 0 where it was heard of in time.
"""

import socket
import sys

from rq.worker import Worker

from server.services.services import Services, connect
from server.settings import Settings
from server.workers import registry

PARTS = ("worker", "renderer", "auditor")


def alive(services: Services, part: str, host: str) -> bool:
    """Whether a process of this kind on a host has told of itself within its lease.

    Workers tell the database, and the others Redis, which forgets those that fall silent.
    """
    if part == "worker":
        with services.sessions.read() as session:
            names = [found.name for found in registry.live(session, services.settings.lease)]
        return any(name.rpartition("-")[0] == host for name in names)
    keys = Worker.redis_worker_namespace_prefix + f"{part}-{host}-*"
    return any(True for _ in services.redis.scan_iter(keys))


def main(arguments: list[str]) -> None:
    if len(arguments) != 1 or arguments[0] not in PARTS:
        sys.exit(f"One part is needed, of {', '.join(PARTS)}; got {' '.join(arguments)!r}")
    services = connect(Settings())
    found = alive(services, arguments[0], socket.gethostname())
    services.close()
    if not found:
        sys.exit(f"No {arguments[0]} on {socket.gethostname()} was heard of in time.")


if __name__ == "__main__":
    main(sys.argv[1:])
