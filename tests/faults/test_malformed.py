"""Malformed files are refused with the reason, and no other file is read."""

import re
import signal
import subprocess
import sys
from itertools import islice

import malformed
import malformed_hdf5
import pytest
from drive import ROOT
from uploads import FALSE_LENGTHS, all_cases, send, send_false_length, watched

EVERY = 32
"""Send every 32nd of about three thousand files; `make acceptance` sends all."""


@pytest.fixture
def canary(tmp_path):
    """Another valid file of this machine, which must not be read."""
    path = tmp_path / "canary.h5"
    path.write_bytes(malformed_hdf5.valid_file())
    return path


def test_malformed_files_are_refused_with_the_reason_and_read_no_other(product, canary):
    with watched(canary) as readings:
        found = send(product, islice(all_cases(canary), 0, None, EVERY))
    assert found.wrong == []
    assert found.refused > 2400 / EVERY
    assert found.growth < 100 << 20
    assert readings == []


def test_a_false_content_length_does_no_harm(product):
    for name, (sent, status) in FALSE_LENGTHS.items():
        answer = send_false_length(product.port, sent)
        assert not answer or status in answer, name
        assert product.http.get("/healthz").status_code == 200


def test_the_file_watch_notices_readings(canary):
    with watched(canary) as readings:
        canary.read_bytes()
    assert readings


REFUSED = {
    "open(canary)": "Too many open files",
    "h5py.File(canary)": "Too many open files",
    "h5py.File(stored)['a'][()]": "Too many open files|external",
    "bytearray(1 << 30)": "MemoryError",
}
"""Actions that the kernel refuses a sandbox, with the error."""


def test_the_kernel_keeps_sandboxes_from_files_and_memory(canary):
    """Even where our own checks of a file fail."""
    text = f"""
import h5py, io, signal
from microcosmos_server.creatures import sandbox_process
canary, stored = {str(canary)!r}, io.BytesIO()
with h5py.File(stored, "w") as file:
    file.create_dataset("a", (8,), "u1", external=[(canary, 0, 8)])
sandbox_process.restrict()
signal.setitimer(signal.ITIMER_REAL, 0)  # A busy machine may take its time.
for action in {list(REFUSED)!r}:
    try:
        print(eval(action))
    except (OSError, MemoryError) as error:
        print("refused", repr(error).replace(chr(10), " "))
"""
    command = [sys.executable, "-c", text]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    for line, (action, error) in zip(done.stdout.splitlines(), REFUSED.items(), strict=True):
        assert re.match(f"refused.*({error})", line), action


@pytest.mark.parametrize(
    ("action", "limit", "ended"),
    [
        ("time.sleep(60)", "WALL_SECONDS", signal.SIGALRM),
        ("while True: pass", "CPU_SECONDS", signal.SIGPROF),
    ],
)
def test_the_kernel_ends_slow_sandboxes(action, limit, ended):
    begin = "import time; from microcosmos_server.creatures import sandbox_process"
    text = f"{begin}\nsandbox_process.{limit} = 0.2\nsandbox_process.restrict()\n{action}"
    done = subprocess.run([sys.executable, "-c", text], cwd=ROOT, check=False)
    assert done.returncode == -ended


def test_a_killed_sandbox_is_replaced(product):
    product.signal("microcosmos_server.creatures.sandbox_process", signal.SIGKILL)
    body = malformed.encoded(malformed.valid_document())
    answers = [product.http.post("/api/v1/creatures", content=body) for _ in range(3)]
    assert {answer.status_code for answer in answers} <= {200, 503}
    assert answers[-1].status_code == 200
