"""The supervisor: takes one run after another and computes each in a process of its own."""

import logging
import os
import socket
import sys
import time
from contextlib import suppress
from functools import partial
from subprocess import PIPE, Popen, TimeoutExpired
from uuid import UUID

from sqlalchemy.exc import SQLAlchemyError

from microcosmos_server.attempts.claim import UNCLAIMED
from microcosmos_server.attempts.leases import Progress, end_job, fail_job, progress
from microcosmos_server.core import logs, processes
from microcosmos_server.core.processes import note_stop_signals, stop_requested
from microcosmos_server.schedule.take import take
from microcosmos_server.services import services
from microcosmos_server.services.services import Services
from microcosmos_server.settings import Settings, from_environment

from . import device
from .heartbeats import HEARTBEATS_PER_LEASE, Heartbeats
from .loop import PAUSE_SECONDS, logging_outages
from .plugins import PluginWatcher
from .readiness import Readiness

IDLE_SECONDS = 1.0
"""Longest time before an idle worker finds a run for which no message woke it."""
STOP_SECONDS = 18.0
"""Seconds for a job to stop on request; fewer than this process itself gets."""
STOP_CHECK_SECONDS = 1.0
"""Longest time between two checks of a job that must stop."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}
"""NumPy rounds matrix products differently with other numbers of threads. That would change the
motion distances that a run records at its end."""

log = logging.getLogger(__name__)


class Supervisor:
    """Carries out runs, one at a time, each in a process, with a lease on it."""

    def __init__(
        self,
        services: Services,
        name: str,
        environment: dict[str, str],
        heartbeats: Heartbeats,
        readiness: Readiness,
        plugins: PluginWatcher,
    ):
        self.services, self.name, self.environment = services, name, environment
        self.heartbeats, self.readiness, self.plugins = heartbeats, readiness, plugins
        self.job: Popen[bytes] | None = None
        self.job_killed = False
        """The job was killed because it has its run no more."""
        self.stop_sent_at: float | None = None
        """Time of the first request to the job to stop."""
        self.error: str | None = None
        """How the last job died; None unless it died by itself."""
        self.error_details: str | None = None
        """The last lines that this job wrote."""
        self.unclaimed = False
        """The last job could not use the database."""

    def serve(self) -> None:
        """Carry out runs until the process has to stop."""
        alarm = self.services.wake.listen()
        while not stop_requested():
            with logging_outages():
                # A run needs a version of each plug-in, and its process loads the files.
                if not (self.readiness.check() and self.plugins.is_current()):
                    self.heartbeats.hurry()
                    time.sleep(PAUSE_SECONDS)
                elif run_id := take(self.services, self.name):
                    self.carry_out(run_id)
                else:
                    alarm.wait(IDLE_SECONDS)
        alarm.close()

    def carry_out(self, run_id: UUID) -> None:
        """Compute a run in a process, and return it to the queue if the process dies."""
        self.error, before = None, progress(self.services, run_id)
        self.job_killed = self.unclaimed = False
        logs.bind(run=str(run_id))
        try:
            if not stop_requested():
                self.start(str(run_id))
                self.monitor(run_id)
        finally:
            try:
                with logging_outages():
                    self.end(run_id, before)
            finally:
                self.heartbeats.release()
                logs.bind(run=None)

    def end(self, run_id: UUID, before: Progress | None) -> None:
        """End the attempt of a job, and count its death unless this host is broken."""
        if self.error and (
            has_computed(before, progress(self.services, run_id))
            or self.readiness.test_device()
        ):
            fail_job(self.services, run_id, self.name, self.error, self.error_details)
        else:
            end_job(self.services, run_id, self.name, broken=bool(self.error))
        if self.unclaimed:
            self.readiness.note_unclaimed()

    def start(self, run_id: str) -> None:
        """Start the job's process."""
        command = processes.python("microcosmos_worker.job_process", run_id, self.name)
        environment = os.environ | ONE_THREAD | self.environment
        self.job = processes.start(command, environment, stderr=PIPE)
        self.output = processes.Output(self.job)
        if stop_requested():  # The signal came before there was a process.
            self.stop_job()

    def monitor(self, run_id: UUID) -> None:
        """Wait for the job's process."""
        assert self.job
        self.heartbeats.watch(run_id, partial(self.kill_job, self.job))
        while (code := self._wait(self.job)) is None:
            if self.stop_sent_at and time.monotonic() - self.stop_sent_at > STOP_SECONDS:
                self.job.kill()  # One block takes too long.
        self.job = None
        self.unclaimed = code == UNCLAIMED
        if code and not self.job_killed and not self.unclaimed:
            how = processes.exit_reason(code)
            log.warning("Run %s: its process %s", run_id, how)
            if not self.stop_sent_at:
                self.error, self.error_details = f"its process {how}", self.output.tail()

    def _wait(self, job: Popen[bytes]) -> int | None:
        """Return the exit status; None after a while, since no signal interrupts a wait."""
        with suppress(TimeoutExpired):
            return job.wait(STOP_CHECK_SECONDS)
        return None

    def kill_job(self, job: Popen[bytes]) -> None:
        self.job_killed = True
        job.kill()

    def stop_job(self) -> None:
        """Ask the job to stop: between blocks, with a checkpoint."""
        if self.job:
            self.stop_sent_at = self.stop_sent_at or time.monotonic()
            self.job.terminate()


def has_computed(before: Progress | None, now: Progress | None) -> bool:
    """Return whether an attempt that began after `before` has recorded a generation."""
    return (
        before is not None
        and now is not None
        and now.attempt > before.attempt
        and now.generation > before.checkpoint
    )


def supervise(settings: Settings, index: int) -> None:
    """Run the worker of this number on this machine until it has to stop."""
    shared = services.connect(settings)
    name = f"{socket.gethostname()}-{os.getpid()}"
    logs.bind(worker=name)
    found = device.find(index, max(1, settings.workers))
    if found.threads:
        device.pin(found.threads)
    plugins = PluginWatcher(settings, settings.lease / HEARTBEATS_PER_LEASE)
    readiness = Readiness(shared, found)
    labels = [one.strip() for one in settings.labels.split(",") if one.strip()]
    heartbeats = Heartbeats(
        shared.sessions, name, found, settings.lease, labels, plugins, readiness
    )
    worker = Supervisor(shared, name, found.environment, heartbeats, readiness, plugins)
    note_stop_signals(worker.stop_job, interrupt=True)
    log.info("Worker %s on %s", name, found.name)
    heartbeats.start()
    plugins.start()
    worker.serve()
    plugins.end()
    with suppress(SQLAlchemyError):
        heartbeats.end()
    shared.close()


if __name__ == "__main__":
    found = from_environment()
    logs.set_up(found)
    supervise(found, int(sys.argv[1]) if len(sys.argv) > 1 else 0)
