"""Several processes behind one port, as with `SERVERS=2`."""

import re
from contextlib import suppress

import httpx
import psutil
import pytest

from microcosmos_server.auth.authenticate import BURST

TOKEN = "a-token-of-the-test-000"


@pytest.fixture
def database():
    return "sqlite"


def serving(process) -> set[psutil.Process]:
    """The processes that answer requests."""
    spawned = set()
    for one in psutil.Process(process.pid).children():
        with suppress(psutil.Error):  # It has ended.
            if "multiprocessing.spawn" in " ".join(one.cmdline()):
                spawned.add(one)
    return spawned


def get(address, path, token=TOKEN):
    """The answer over a connection of its own, so of any process; None where none answers."""
    with suppress(httpx.TransportError):
        return httpx.get(address + path, headers={"Authorization": f"Bearer {token}"})
    return None


def counted(address) -> float:
    found = get(address, "/metrics").text
    (line,) = re.findall(
        r'^microcosmos_requests_total\{.*route="/healthz".*\} (.*)$', found, re.M
    )
    return float(line)


@pytest.mark.long
def test_processes_share_a_port_a_rate_and_figures(start_server, eventually):
    """Both processes end with the first, which is killed."""
    with start_server(SERVERS="2", MICROCOSMOS_TOKEN=TOKEN) as (first, address):
        eventually(lambda: len(serving(first)) == 2)
        before = counted(address)
        for _ in range(20):
            get(address, "/healthz")
        assert {counted(address) for _ in range(6)} == {before + 20}
        wrong = [get(address, "/api/v1/runs", "wrong").status_code for _ in range(3 * BURST)]
        assert set(wrong) == {401, 429}
        assert wrong.count(401) <= BURST
        assert get(address, "/api/v1/runs").status_code == 200
        killed, other = sorted(serving(first), key=lambda one: one.pid)
        killed.kill()
        eventually(lambda: len(serving(first) - {killed, other}) == 1)
        eventually(lambda: get(address, "/readyz").status_code == 200)
        orphans = serving(first)
        first.kill()
        assert not psutil.wait_procs(orphans, timeout=30)[1]
