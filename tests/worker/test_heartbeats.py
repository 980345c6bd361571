"""The thread that reports a worker."""

import threading

import pytest
from sqlalchemy.exc import OperationalError

from worker.device import Device
from worker.heartbeats import Heartbeats


@pytest.mark.parametrize(
    "error", [OperationalError("", {}, Exception("it is away")), PermissionError("no gauge")]
)
def test_heartbeats_go_on_after_any_error(services, monkeypatch, error):
    device = Device("a processor", 8 << 30, {})
    heartbeats = Heartbeats(services.sessions, "worker", device, lease=0.1)
    beat, again = heartbeats.beat, threading.Event()

    def fail_once():
        monkeypatch.setattr(heartbeats, "beat", lambda: (beat(), again.set()))
        raise error

    monkeypatch.setattr(heartbeats, "beat", fail_once)
    heartbeats.start()
    assert again.wait(10.0)
    heartbeats.end()
