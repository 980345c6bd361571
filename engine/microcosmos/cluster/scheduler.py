"""The scheduler, by which runs and helpers find each other; its address and certificate."""

import asyncio
import logging
import os
import signal
from collections.abc import Callable
from ipaddress import ip_address
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from ..optional import require

DEFAULT_PORT = 8786
PACKAGE = "microcosmos[cluster]"


def security(url: str, certificate: Path | None):
    """Return Dask's `Security` for an address such as tls://host:8786.

    The file of `write_certificate` holds a certificate and its key. Everybody who has it may
    join the cluster and run programs on every helper. Without TLS an address must be of this
    machine, and needs none. Raises `ValueError` for another address, and for a certificate
    that is missing.
    """
    distributed = require("distributed", PACKAGE)
    parts = urlsplit(url)
    if parts.scheme not in ("tls", "tcp") or not parts.hostname or not parts.port:
        raise ValueError(f"the cluster must be like tls://host:{DEFAULT_PORT}, got {url!r}")
    if parts.scheme == "tcp":
        if not _is_loopback(parts.hostname):
            raise ValueError(
                f"tcp:// is only for this machine (127.0.0.1), got {url!r}: use tls:// and a "
                "certificate (microcosmos cluster certificate FILE)"
            )
        return None  # Also with a certificate: the environment names one for all addresses.
    if certificate is None:
        raise ValueError(
            "tls:// needs a certificate; make one: microcosmos cluster certificate FILE"
        )
    if not certificate.is_file():
        raise ValueError(f"the certificate must be a file, got {certificate}")
    file = str(certificate)
    roles = ("client", "scheduler", "worker")
    files = {f"tls_{role}_{part}": file for role in roles for part in ("cert", "key")}
    return distributed.Security(require_encryption=True, tls_ca_file=file, **files)


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def write_certificate(path: Path) -> None:
    """Write a new certificate, valid for a year, and its key, for all hosts of a cluster.

    Only the file's owner may read it. Raises `FileExistsError` rather than replace a file.
    """
    require("cryptography", PACKAGE)
    made = require("distributed", PACKAGE).Security.temporary()
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    with os.fdopen(os.open(path, flags, 0o600), "w") as file:
        file.write(f"{made.tls_client_key.strip()}\n{made.tls_client_cert.strip()}\n")


CONFIGURATION = {
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
    # A helper that does not answer is taken to be gone.
    "distributed.scheduler.worker-ttl": "60s",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.gil.enabled": False,
}
"""A run places its blocks itself, and sends them again when a helper leaves."""


HTTP = "127.0.0.1:0"
"""Address of Dask's own pages: this machine alone, since they have no TLS."""


def configured() -> Any:
    """Return Dask's `distributed`, configured."""
    distributed = require("distributed", PACKAGE)
    require("dask", PACKAGE).config.set(CONFIGURATION)
    # Dask logs a page for each lost connection; we expect these and log one line.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    return distributed


def serve(url: str, certificate: Path | None, on_listening: Callable[[str], object]) -> None:
    """Run the scheduler at an address until a signal; call `on_listening` with the address.

    Raises `ValueError` for an address or certificate that may not be used, and `OSError` where
    nothing can listen.
    """
    asyncio.run(_serve(url, certificate, on_listening))


async def _serve(
    url: str, certificate: Path | None, on_listening: Callable[[str], object]
) -> None:
    distributed, parts = configured(), urlsplit(url)
    options = {
        "host": parts.hostname,
        "port": parts.port,
        "protocol": parts.scheme,
        "security": security(url, certificate),
        "dashboard": False,
        "dashboard_address": HTTP,
    }
    async with distributed.Scheduler(**options) as scheduler:
        end_with_signal(scheduler)
        on_listening(scheduler.address)
        await scheduler.finished()


def end_with_signal(server: Any) -> asyncio.Event:
    """Let SIGINT and SIGTERM close a scheduler or a helper; return whether one came."""
    loop, ended, closing = asyncio.get_running_loop(), asyncio.Event(), set[asyncio.Task]()

    def end() -> None:
        ended.set()
        closing.add(asyncio.create_task(server.close()))

    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, end)
    return ended
