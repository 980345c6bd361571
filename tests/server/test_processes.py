"""Several processes behind one port, as with `SERVERS=2`."""

import os
import re
import signal
import socket
import subprocess
import sys
from contextlib import suppress

import httpx
import psutil
import pytest

from server.auth.authenticate import BURST

TOKEN = "a-token-of-the-test-000"


@pytest.fixture
def database():
    return "sqlite"


@pytest.fixture
def server(services, tmp_path):
    """The first process of a server that needs a token."""
    settings = services.settings
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = os.environ | {
        "PORT": str(port),
        "SERVERS": "2",
        "MICROCOSMOS_TOKEN": TOKEN,
        "MICROCOSMOS_DATA": str(tmp_path),
        "MICROCOSMOS_DATABASE_URL": settings.database_url,
        "MICROCOSMOS_REDIS_URL": settings.redis_url,
        "MICROCOSMOS_REDIS_PREFIX": settings.redis_prefix,
    }
    command = [sys.executable, "-m", "server.main"]
    with subprocess.Popen(command, env=environment) as process:
        process.url = f"http://127.0.0.1:{port}"
        try:
            yield process
        finally:
            process.terminate()


def serving(server) -> set[psutil.Process]:
    """The processes that answer requests."""
    spawned = set()
    for one in psutil.Process(server.pid).children():
        with suppress(psutil.Error):  # It has ended.
            if "multiprocessing.spawn" in " ".join(one.cmdline()):
                spawned.add(one)
    return spawned


def get(server, path, token=TOKEN):
    """The answer over a connection of its own, so of any process; None where none answers."""
    with suppress(httpx.TransportError):
        return httpx.get(server.url + path, headers={"Authorization": f"Bearer {token}"})
    return None


def counted(server) -> float:
    found = get(server, "/metrics").text
    (line,) = re.findall(
        r'^microcosmos_requests_total\{.*route="/healthz".*\} (.*)$', found, re.M
    )
    return float(line)


@pytest.mark.long
def test_processes_share_a_port_a_rate_and_figures(server, eventually):
    eventually(lambda: get(server, "/healthz"))
    eventually(lambda: len(serving(server)) == 2)
    before = counted(server)
    for _ in range(20):
        get(server, "/healthz")
    assert {counted(server) for _ in range(6)} == {before + 20}
    wrong = [get(server, "/api/v1/runs", "wrong").status_code for _ in range(3 * BURST)]
    assert set(wrong) == {401, 429}
    assert wrong.count(401) <= BURST
    assert get(server, "/api/v1/runs").status_code == 200

    killed, other = sorted(serving(server), key=lambda one: one.pid)
    killed.kill()
    eventually(lambda: len(serving(server) - {killed, other}) == 1)
    eventually(lambda: get(server, "/readyz").status_code == 200)
    orphans = serving(server)
    server.send_signal(signal.SIGKILL)
    assert not psutil.wait_procs(orphans, timeout=30)[1]
