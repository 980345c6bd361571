"""How much of a device is in use."""

import os
from threading import Event

import pytest

from server.workers import registry
from worker import usage
from worker.device import Device, memory
from worker.pulse import Pulse
from worker.usage import Usage


def test_a_processor_tells_the_machines_load_a_core_and_memory_that_is_taken():
    found = usage.usage(Device("cpu", memory(), {}))
    assert found.load is not None
    assert found.load == pytest.approx(os.getloadavg()[0] / os.cpu_count(), abs=0.5)
    assert found.memory_bytes is not None
    assert 0 < found.memory_bytes < memory()


@pytest.mark.parametrize(
    ("current", "expected"), [("1000", 990), ("5", 0), ("no number", None)]
)
def test_in_a_container_its_own_memory_is_told(tmp_path, monkeypatch, current, expected):
    (tmp_path / "memory.max").write_text("2000")
    (tmp_path / "memory.current").write_text(current)
    (tmp_path / "memory.stat").write_text("inactive_file 10\n")
    monkeypatch.setattr(usage, "GROUP", tmp_path)
    found = usage.usage(Device("cpu", 1, {}))
    assert (found.memory_bytes, found.load is None) == (expected, False)


@pytest.mark.parametrize(
    ("used", "load", "expected"),
    [(1234, 56, Usage(1234, 0.56)), (1234, None, Usage(1234, None)), (None, None, Usage())],
)
def test_a_gpu_tells_its_own_and_none_for_what_it_does_not_tell(nvml, used, load, expected):
    nvml({"GPU-3": ("a GPU", 80 << 30)}, used=used, load=load)
    assert usage.usage(Device("gpu", 80 << 30, {}, "GPU-3")) == expected


def test_without_a_driver_a_gpus_usage_is_unknown(nvml):
    nvml(None)
    assert usage.usage(Device("gpu", 80 << 30, {}, "GPU-3")) == Usage()


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
