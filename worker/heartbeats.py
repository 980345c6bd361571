"""Heartbeats of a worker and of its run, sent by a thread of their own."""

import logging
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from uuid import UUID

from sqlalchemy.exc import SQLAlchemyError

from server.attempts import leases
from server.attempts.leases import LeaseState
from server.core.database import Sessions
from server.workers import registry

from .device import Device
from .nvidia import XidErrors
from .plugins import PluginReport, PluginWatcher
from .readiness import Readiness
from .usage import Gauge, usage

HEARTBEATS_PER_LEASE = 4
HEARTBEATS_AFTER_END = 2
"""Heartbeats between the end of a run and killing its job."""

log = logging.getLogger(__name__)


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

    def _end_lost_job(self, watch: Watch, lease: LeaseState) -> None:
        """Kill the job if another worker has its run, or if the run ended some time ago."""
        watch.held |= lease == "held"
        watch.since_end = watch.since_end + 1 if lease == "over" and watch.held else 0
        if (lease == "lost" or watch.since_end > HEARTBEATS_AFTER_END) and watch is self._watch:
            log.warning("Run %s is lost: killing its job", watch.run)
            watch.kill()
