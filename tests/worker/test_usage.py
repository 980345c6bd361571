"""How much of a device is in use."""

import os
import stat
from threading import Event

import pytest

from server.workers import registry
from worker import usage
from worker.device import MIB, Device, memory
from worker.pulse import Pulse
from worker.usage import Usage


@pytest.fixture
def answering(tmp_path, monkeypatch):
    """An `nvidia-smi` that answers so, and notes what it was asked."""

    def answering(line, code=0):
        script = tmp_path / "nvidia-smi"
        words = (f'echo "$@" > {tmp_path}/asked', f"echo '{line}'", f"exit {code}")
        script.write_text("\n".join(("#!/bin/sh", *words)))
        script.chmod(script.stat().st_mode | stat.S_IEXEC)
        monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
        return tmp_path / "asked"

    return answering


def test_a_processor_tells_the_machines_load_a_core_and_memory_that_is_taken():
    found = usage.usage(Device("cpu", memory(), {}))
    assert found.load is not None
    assert found.load == pytest.approx(os.getloadavg()[0] / os.cpu_count(), abs=0.5)
    assert found.memory_bytes is not None
    assert 0 < found.memory_bytes < memory()


def test_where_the_system_tells_no_memory_the_load_is_told_all_the_same(tmp_path, monkeypatch):
    monkeypatch.setattr(usage, "GROUP", tmp_path / "none")
    monkeypatch.setattr(usage, "MEMINFO", tmp_path / "none")
    found = usage.usage(Device("cpu", 1, {}))
    assert (found.memory_bytes, found.load is None) == (None, False)
    (tmp_path / "memory.max").write_text("1000")
    (tmp_path / "memory.current").write_text("no number")
    (tmp_path / "memory.stat").write_text("inactive_file 10")
    monkeypatch.setattr(usage, "GROUP", tmp_path)
    assert usage.memory_in_use() is None


def test_a_gpu_tells_its_own(answering):
    asked = answering("1234, 56")
    found = usage.usage(Device("gpu", 80 << 30, {}, "3"))
    assert found == Usage(1234 * MIB, 0.56)
    assert "-i 3 --query-gpu=memory.used,utilization.gpu" in asked.read_text()


@pytest.mark.parametrize(
    ("line", "code", "expected"),
    [
        ("1234, [N/A]", 0, Usage(1234 * MIB, None)),
        ("[N/A], [N/A]", 0, Usage()),
        ("1234, 56", 9, Usage()),
        ("", 0, Usage()),
    ],
)
def test_what_a_gpu_does_not_tell_is_none(answering, line, code, expected):
    answering(line, code)
    assert usage.of_gpu("0") == expected


def test_a_beat_tells_what_was_seen_last(services):
    pulse = Pulse(services.sessions, "worker", Device("gpu", 8 << 30, {}, "0"), lease=20)
    pulse.gauge.last = Usage(5, 0.25)
    pulse.beat()
    with services.sessions.read() as session:
        (found,) = registry.live(session, 20)
    assert (found.kind, found.memory_used_bytes, found.load) == ("gpu", 5, 0.25)


def test_a_gauge_looks_until_its_end():
    seen, enough = [], Event()

    def look():
        seen.append(Usage(load=float(len(seen))))
        if len(seen) == 3:
            enough.set()
        return seen[-1]

    gauge = usage.Gauge(look, 0.001)
    gauge.start()
    assert enough.wait(20)
    gauge.end()
    gauge.join()
    assert gauge.last == seen[-1]


@pytest.mark.parametrize("error", [OSError("gone"), ValueError("no number")])
def test_a_gauge_that_fails_once_tells_nothing_old_and_looks_again(error):
    failed, go_on, enough = Event(), Event(), Event()
    looks = iter([Usage(load=1.0), error])

    def look():
        found = next(looks, None)
        if isinstance(found, Exception):
            raise found
        if found is None:
            failed.set()
            assert go_on.wait(20)
            enough.set()
        return found or Usage(load=2.0)

    gauge = usage.Gauge(look, 0.001)
    gauge.start()
    assert failed.wait(20)
    assert gauge.last == Usage(), "what was seen before the failure is old"
    go_on.set()
    assert enough.wait(20)
    gauge.end()
    gauge.join()
    assert gauge.last == Usage(load=2.0)
