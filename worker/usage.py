"""How much of a worker's device is in use, by anybody."""

import logging
import os
import subprocess
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .device import MIB, Device, memory

QUERY = ("--query-gpu=memory.used,utilization.gpu", "--format=csv,noheader,nounits")
NVIDIA_SECONDS = 10
GROUP = Path("/sys/fs/cgroup")
MEMINFO = Path("/proc/meminfo")

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Usage:
    """None where it cannot be told."""

    memory_bytes: int | None = None
    load: float | None = None
    """1 is fully."""


class Gauge(threading.Thread):
    """Looks again and again, in a thread of its own: a slow answer delays nobody."""

    def __init__(self, look: Callable[[], Usage], interval: float):
        super().__init__(name="gauge", daemon=True)
        self._look, self._interval = look, interval
        self._ended = threading.Event()
        self.last = Usage()

    def run(self) -> None:
        while not self._ended.is_set():
            try:
                self.last = self._look()
            except (OSError, ValueError) as error:  # It may be told the next time.
                log.debug("Nobody tells how busy the device is: %s", error)
                self.last = Usage()
            self._ended.wait(self._interval)

    def end(self) -> None:
        self._ended.set()


def usage(device: Device) -> Usage:
    """The GPU's own, else the machine's: its load is the average over a minute, a core."""
    if device.gpu is not None:
        return of_gpu(device.gpu)
    return Usage(memory_in_use(), os.getloadavg()[0] / (os.cpu_count() or 1))


def of_gpu(gpu: str) -> Usage:
    try:
        answer = subprocess.run(
            ["nvidia-smi", "-i", gpu, *QUERY],
            check=False,
            capture_output=True,
            text=True,
            timeout=NVIDIA_SECONDS,
        )
    except (OSError, subprocess.TimeoutExpired):
        return Usage()
    return Usage() if answer.returncode else parsed(answer.stdout)


def parsed(line: str) -> Usage:
    """MiB and percent; a part that a GPU does not tell is `[N/A]`."""
    used, _, busy = line.strip().partition(",")
    numbers = [int(part) if part.strip().isdigit() else None for part in (used, busy)]
    return Usage(
        memory_bytes=None if numbers[0] is None else numbers[0] * MIB,
        load=None if numbers[1] is None else numbers[1] / 100,
    )


def memory_in_use() -> int | None:
    """Bytes that cannot be had: of the control group where that has a limit, else all."""
    try:
        return _of_group() if _limited() else _of_machine()
    except (OSError, ValueError):  # Other systems tell it otherwise.
        return None


def _limited() -> bool:
    limit = GROUP / "memory.max"
    return limit.exists() and limit.read_text().strip() != "max"


def _of_group() -> int:
    cached = _figures(GROUP / "memory.stat").get("inactive_file", 0)
    return max(0, int((GROUP / "memory.current").read_text()) - cached)


def _of_machine() -> int | None:
    available = _figures(MEMINFO).get("MemAvailable:")
    return None if available is None else max(0, memory() - 1024 * available)


def _figures(path: Path) -> dict[str, int]:
    rows = (line.split() for line in path.read_text().splitlines())
    return {row[0]: int(row[1]) for row in rows if len(row) > 1 and row[1].isdigit()}
