"""Heartbeats of a worker and its run, with the usage of the device, in threads of their own."""

import logging
import os
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from uuid import UUID

import psutil
from sqlalchemy.exc import SQLAlchemyError

from microcosmos_server.attempts import leases
from microcosmos_server.attempts.leases import LeaseState
from microcosmos_server.core.database import Sessions
from microcosmos_server.workers import registry

from . import nvidia
from .device import Device
from .nvidia import XidErrors
from .plugins import PluginReport, PluginWatcher
from .readiness import Readiness

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


HEARTBEATS_PER_LEASE = 4
HEARTBEATS_AFTER_END = 2
"""Heartbeats between the end of a run and killing its job."""


@dataclass
class Watch:
    """The run of a job process, and the state of its lease."""

    run: UUID
    kill: Callable[[], None]
    held: bool = False
    since_end: int = 0  # Heartbeats since the run ended.


class Heartbeats(threading.Thread):
    """Writes heartbeats to SQL only, so that no lease expires while Redis is away."""

    def __init__(
        self,
        sessions: Sessions,
        worker: str,
        device: Device,
        lease: float,
        labels: Sequence[str] = (),
        plugins: PluginWatcher | None = None,
        readiness: Readiness | None = None,
    ):
        super().__init__(name="heartbeat", daemon=True)
        self._sessions, self._worker, self._device = sessions, worker, device
        self._labels, self._plugins, self._readiness = list(labels), plugins, readiness
        self._interval = lease / HEARTBEATS_PER_LEASE
        self.gauge = Gauge(partial(usage, device), self._interval)
        self._errors = XidErrors(device.gpu) if device.gpu else None
        self._errors_reported = 0
        self._ended = threading.Event()
        self._due = threading.Event()
        self._watch: Watch | None = None

    def run(self) -> None:
        self.gauge.start()
        while not self._ended.is_set():
            try:
                self.beat()
            except SQLAlchemyError as error:
                log.warning("No heartbeat: the database does not answer: %s", error)
            except Exception:  # Without this thread the worker would lose every run it takes.
                log.exception("No heartbeat")
            self._due.wait(self._interval)
            self._due.clear()

    def watch(self, run: UUID, kill: Callable[[], None]) -> None:
        """Also renew the lease on a run; `kill` ends its job if the run is lost."""
        self._watch = Watch(run, kill)
        self.hurry()  # The worker's status changes at once.

    def release(self) -> None:
        self._watch = None
        self.hurry()

    def hurry(self) -> None:
        """Send the next heartbeat now."""
        self._due.set()

    def end(self) -> None:
        """Stop, and remove the worker from the registry."""
        self._ended.set()
        self._due.set()
        self.gauge.end()
        self.join()
        registry.retire(self._sessions, self._worker)

    def beat(self) -> None:
        watch, ready = self._watch, self._readiness
        plugins = self._plugins.report if self._plugins else PluginReport()
        errors = self._errors.read() if self._errors else 0
        problem = ready.problem if ready else None
        lease: LeaseState | None = None
        if watch:
            lease = leases.heartbeat(self._sessions, watch.run, self._worker)
            self._end_lost_job(watch, lease)
        registry.report(
            self._sessions,
            self._worker,
            self._device.name,
            self._device.memory_bytes,
            "busy" if watch else "idle",
            watch.run if watch and lease == "held" else None,
            kind="cpu" if self._device.gpu is None else "gpu",
            memory_used_bytes=self.gauge.last.memory_bytes,
            load=self.gauge.last.load,
            plugins=list(plugins.plugins),
            unloaded=list(plugins.unloaded),
            labels=self._labels,
            device_kinds=ready.device_kinds if ready else [],
            problem=problem.text if problem else None,
            problem_kind=problem.kind if problem else None,
            gpu=self.gauge.last.gpu,
            xid_errors=errors - self._errors_reported,
        )
        self._errors_reported = errors
        if self._plugins:
            self._plugins.reported = plugins

    def _end_lost_job(self, watch: Watch, lease: LeaseState) -> None:
        """Kill the job if another worker has its run, or if the run ended some time ago."""
        watch.held |= lease == "held"
        watch.since_end = watch.since_end + 1 if lease == "over" and watch.held else 0
        if (lease == "lost" or watch.since_end > HEARTBEATS_AFTER_END) and watch is self._watch:
            if lease == "lost":
                log.warning("Another worker has run %s: killing its job here", watch.run)
            else:
                log.info("Run %s has ended, and its process has not: ending it", watch.run)
            watch.kill()
