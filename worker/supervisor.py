"""The supervisor: takes one run after another and computes each in a process of its own."""

import logging
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from uuid import UUID

from sqlalchemy.exc import SQLAlchemyError

from server.attempts.leases import Progress, end_job, fail_job, progress
from server.core import logs
from server.schedule.take import take
from server.services import services
from server.services.services import Services
from server.settings import Settings

from . import device
from .heartbeats import HEARTBEATS_PER_LEASE, Heartbeats
from .job_output import JobOutput
from .loop import PAUSE_SECONDS, logging_outages
from .plugins import PluginWatcher
from .process_setup import handle_signals, stop_requested
from .readiness import Readiness

IDLE_SECONDS = 1.0
"""Longest time before an idle worker notices a run of which no message told it."""
STOP_SECONDS = 18.0
"""Seconds that a job has to stop on request; fewer than this process itself has."""
STOP_CHECK_SECONDS = 1.0
"""Longest time between two checks of a job that must stop."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}
"""NumPy's products of matrices round differently with other numbers of threads, and with them
the distances of motions with which a run's curves end."""

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
    ):
        self.services, self.name, self.environment = services, name, environment
        self.heartbeats, self.readiness = heartbeats, readiness
        self.job: subprocess.Popen[bytes] | None = None
        self.stop_sent_at: float | None = None
        """Time of the first request to the job to stop."""
        self.error: str | None = None
        """How the last job died, unless this process had asked it to stop."""

    def serve(self) -> None:
        """Carry out runs until the process has to stop."""
        alarm = self.services.wake.listen()
        while not stop_requested():
            with logging_outages():
                if not self.readiness.check():
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
            fail_job(self.services, run_id, self.name, self.error)
        else:
            end_job(self.services, run_id, self.name, broken=bool(self.error))

    def start(self, run_id: str) -> None:
        """Start the job's process. Other users can read its arguments: no secrets."""
        self.job = subprocess.Popen(
            [sys.executable, "-m", "worker.job_process", run_id, self.name, str(os.getpid())],
            env=os.environ | ONE_THREAD | self.environment,
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            process_group=0,
        )
        self.output = JobOutput(self.job)
        if stop_requested():  # The signal came before there was a process.
            self.stop_job()

    def monitor(self, run_id: UUID) -> None:
        """Wait for the job's process."""
        assert self.job
        self.heartbeats.watch(run_id, self.job.kill)
        while (code := self._wait(self.job)) is None:
            if self.stop_sent_at and time.monotonic() - self.stop_sent_at > STOP_SECONDS:
                self.job.kill()  # One block takes too long.
        self.job = None
        if code:
            how = death(code)
            log.warning("Run %s: its process %s", run_id, how)
            if not self.stop_sent_at:
                self.error = "\n".join(filter(None, (f"its process {how}", self.output.tail())))

    def _wait(self, job: subprocess.Popen[bytes]) -> int | None:
        """Return how the job ended. A signal to this process ends no wait, so look again."""
        with suppress(subprocess.TimeoutExpired):
            return job.wait(STOP_CHECK_SECONDS)
        return None

    def stop_job(self) -> None:
        """Ask the job to stop: between blocks, with a checkpoint."""
        if self.job:
            self.stop_sent_at = self.stop_sent_at or time.monotonic()
            self.job.terminate()


def has_computed(before: Progress | None, now: Progress | None) -> bool:
    """Return whether an attempt that began between has recorded a generation."""
    return (
        before is not None
        and now is not None
        and now.attempt > before.attempt
        and now.generation > before.checkpoint
    )


def death(code: int) -> str:
    """Say how a process ended with a status other than 0."""
    if code >= 0:
        return f"ended with status {code}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    hint = ", perhaps for lack of memory" if -code == signal.SIGKILL else ""
    return f"was killed by {name}{hint}"


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
    worker = Supervisor(shared, name, found.environment, heartbeats, readiness)
    handle_signals(worker.stop_job, interrupt=True)
    log.info("Worker %s on %s", name, found.name)
    heartbeats.start()
    plugins.start()
    worker.serve()
    plugins.end()
    with suppress(SQLAlchemyError):
        heartbeats.end()
    shared.close()


if __name__ == "__main__":
    found = Settings()
    logs.set_up(found)
    supervise(found, int(sys.argv[1]) if len(sys.argv) > 1 else 0)
