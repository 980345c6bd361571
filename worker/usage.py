"""Memory use and load of a worker's device, by all programs."""

import logging
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from . import nvidia
from .device import Device

CGROUP = Path("/sys/fs/cgroup")

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Usage:
    """Memory in use and load; None if unknown."""

    memory_bytes: int | None = None
    load: float | None = None
    """1 is fully busy."""
    gpu: dict[str, Any] | None = None
    """UUID, temperature and memory errors of the GPU, if that is the device."""


class Gauge(threading.Thread):
    """Measures periodically in its own thread: a slow measurement delays no heartbeat."""

    def __init__(self, measure: Callable[[], Usage], interval: float):
        super().__init__(name="gauge", daemon=True)
        self._measure, self._interval = measure, interval
        self._ended = threading.Event()
        self.last = Usage()

    def run(self) -> None:
        while not self._ended.is_set():
            try:
                self.last = self._measure()
            except (OSError, ValueError) as error:
                log.debug("The device's usage is unknown: %s", error)
                self.last = Usage()
            self._ended.wait(self._interval)

    def end(self) -> None:
        self._ended.set()


def usage(device: Device) -> Usage:
    """Measure the GPU, else the machine: its load is the average over a minute, per core."""
    if device.gpu is not None:
        found = nvidia.measure(device.gpu)
        gpu = {"uuid": device.gpu, "ecc_errors": found.ecc_errors}
        gpu |= {"temperature_celsius": found.temperature_celsius}
        return Usage(found.memory_bytes, found.load, gpu)
    return Usage(memory_in_use(), psutil.getloadavg()[0] / (os.cpu_count() or 1))


def memory_in_use() -> int | None:
    """Return the bytes in use by the control group, if it has a limit, else by the machine."""
    limit = CGROUP / "memory.max"
    if not limit.exists() or limit.read_text().strip() == "max":
        memory = psutil.virtual_memory()
        return memory.total - memory.available
    try:
        rows = map(str.split, (CGROUP / "memory.stat").read_text().splitlines())
        cached = next((int(row[1]) for row in rows if row[0] == "inactive_file"), 0)
        return max(0, int((CGROUP / "memory.current").read_text()) - cached)
    except (OSError, ValueError):  # Control groups of version 1 have other files.
        return None
