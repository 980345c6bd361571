"""How busy a worker's device is, whoever uses it."""

import logging
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import psutil

from . import nvidia
from .device import Device

GROUP = Path("/sys/fs/cgroup")

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Usage:
    """None for what is unknown."""

    memory_bytes: int | None = None
    load: float | None = None
    """1 is fully."""


class Gauge(threading.Thread):
    """Measures again and again, in a thread of its own: a slow answer delays nobody."""

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
    """Measure the GPU, else the machine: its load is the average over a minute, a core."""
    if device.gpu is not None:
        return Usage(*nvidia.measured(device.gpu))
    return Usage(memory_in_use(), psutil.getloadavg()[0] / (os.cpu_count() or 1))


def memory_in_use() -> int | None:
    """Bytes in use: of the control group if that has a limit, else of the machine."""
    limit = GROUP / "memory.max"
    if not limit.exists() or limit.read_text().strip() == "max":
        memory = psutil.virtual_memory()
        return memory.total - memory.available
    try:
        rows = map(str.split, (GROUP / "memory.stat").read_text().splitlines())
        cached = next((int(row[1]) for row in rows if row[0] == "inactive_file"), 0)
        return max(0, int((GROUP / "memory.current").read_text()) - cached)
    except (OSError, ValueError):  # Control groups of version 1 have other files.
        return None
