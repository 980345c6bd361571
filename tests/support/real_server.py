"""The server as a process of its own."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import httpx

from microcosmos_server.local.redis_embedded import free_port
from microcosmos_server.settings import Settings

ROOT = Path(__file__).parents[2]


@contextmanager
def started(
    output: IO[bytes] | None = None, **settings: str
) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """Start a server on a free port; yield its process and its address once it answers."""
    port = free_port()
    process = subprocess.Popen(
        [sys.executable, "-m", "microcosmos_server.main"],
        cwd=ROOT,
        env=os.environ | settings | {"PORT": str(port)},
        stdout=output,
        stderr=output,
    )
    host = settings.get("MICROCOSMOS_HOST", "127.0.0.1")
    address = Settings(host=host, PORT=port).address
    try:
        deadline = time.monotonic() + 60
        while not answers(f"{address}/healthz"):
            assert time.monotonic() < deadline, "the server does not answer"
            assert process.poll() is None, "the server did not start"
            time.sleep(0.05)
        yield process, address
    finally:
        process.terminate()
        process.wait()


def answers(url: str) -> bool:
    try:
        return httpx.get(url).status_code == 200
    except httpx.TransportError:
        return False
