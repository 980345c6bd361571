"""The scheduler, through which runs and helpers find each other."""

import asyncio
import logging
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from ..optional import require
from .security import PACKAGE, security

CONFIGURATION = {
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
    # A helper that does not answer is taken to be gone.
    "distributed.scheduler.worker-ttl": "60s",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.gil.enabled": False,
}
"""A run places its blocks itself, and knows what to do when a helper leaves."""


HTTP = "127.0.0.1:0"
"""Where Dask's own pages listen: on this machine alone, they know no TLS."""


def configured() -> Any:
    """Return Dask's `distributed`, configured."""
    distributed = require("distributed", PACKAGE)
    require("dask", PACKAGE).config.set(CONFIGURATION)
    # It logs a page for each connection that is lost, which we expect and say in a line.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    return distributed


def serve(url: str, certificate: Path | None, told: Callable[[str], object]) -> None:
    """Run the scheduler at an address until a signal; `told` gets the address once it listens.

    Raises `ValueError` for an address or certificate that may not be used, and `OSError` where
    nothing can listen.
    """
    asyncio.run(_serve(url, certificate, told))


async def _serve(url: str, certificate: Path | None, told: Callable[[str], object]) -> None:
    distributed, parts = configured(), urlsplit(url)
    asked = {
        "host": parts.hostname,
        "port": parts.port,
        "protocol": parts.scheme,
        "security": security(url, certificate),
        "dashboard": False,
        "dashboard_address": HTTP,
    }
    async with distributed.Scheduler(**asked) as scheduler:
        end_with_signal(scheduler)
        told(scheduler.address)
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
