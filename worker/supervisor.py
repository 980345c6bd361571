"""The supervisor: takes runs from the queue and computes each in a process of its own."""

import logging
import os
import socket
import subprocess
import sys
import time
from contextlib import suppress
from uuid import UUID

from rq.job import Job
from rq.queue import Queue
from rq.serializers import JSONSerializer
from rq.worker import BaseWorker
from sqlalchemy.exc import SQLAlchemyError

from server.attempts.leases import end_job
from server.queue.order import in_order
from server.services import services
from server.services.services import Services
from server.settings import Settings

from . import device, loop
from .heartbeats import HEARTBEATS_PER_LEASE, Heartbeats
from .plugins import PluginWatcher
from .process_setup import handle_signals, log_to_stderr, stop_requested

SHORTEST_LEASE = 2
"""Shortest lease in Redis, in seconds."""
STOP_SECONDS = 18.0
"""Seconds that a job has to stop on request; fewer than this process itself has."""
STOP_CHECK_SECONDS = 1.0
"""Longest time between two checks of a job that must stop."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}
"""NumPy's products of matrices round differently with other numbers of threads, and with them
the distances of motions with which a run's curves end."""

log = logging.getLogger(__name__)


class Supervisor(BaseWorker):
    """An RQ worker that runs each job in a process, with a lease on its run.

    SQL records the end of a run, so the job is only deleted from Redis.
    """

    services: Services
    heartbeats: Heartbeats
    lease: int
    environment: dict[str, str]
    job: subprocess.Popen[bytes] | None = None
    stop_sent_at: float | None = None
    """Time of the first request to the job to stop."""
    killed: bool = False
    """The job did not stop on request."""

    def execute_job(self, job: Job, queue: Queue) -> None:
        """Carry out a run; requeue it if its process died."""
        run_id = UUID(job.id)
        try:
            if not stop_requested():
                self.prepare_execution(job)
                self.start(job.id)
                self.monitor(job)
        finally:
            self.heartbeats.release()
            with loop.logging_outages():
                self.services.jobs.remove(job.id)
            with loop.logging_outages():
                error = None if self.killed else "the process of the job died unexpectedly"
                end_job(self.services, run_id, self.name, error)

    def start(self, run_id: str) -> None:
        """Start the job's process. Other users can read its arguments: no secrets."""
        self.job = subprocess.Popen(
            [sys.executable, "-m", "worker.job_process", run_id, self.name, str(os.getpid())],
            env=os.environ | ONE_THREAD | self.environment,
            stdin=subprocess.DEVNULL,
            process_group=0,
        )
        if stop_requested():  # The signal came before there was a process.
            self.stop_job()

    def monitor(self, job: Job) -> None:
        """Wait for the job's process, and keep its lease in Redis alive."""
        assert self.job
        self.heartbeats.watch(UUID(job.id), self.job.kill)
        while (code := self._wait(self.job)) is None:
            with loop.logging_outages():
                self.maintain_heartbeats(job)
            if self.stop_sent_at and time.monotonic() - self.stop_sent_at > STOP_SECONDS:
                self.killed = True  # One block takes too long.
                self.job.kill()
        self.job = None
        if code:
            log.warning("Run %s: its process ended with %s", job.id, code)

    def _wait(self, job: subprocess.Popen[bytes]) -> int | None:
        with suppress(subprocess.TimeoutExpired):
            return job.wait(
                STOP_CHECK_SECONDS if self.stop_sent_at else self.lease / HEARTBEATS_PER_LEASE
            )
        return None

    def stop_job(self) -> None:
        """Ask the job to stop: between blocks, with a checkpoint."""
        if self.job:
            self.stop_sent_at = self.stop_sent_at or time.monotonic()
            self.job.terminate()

    def get_heartbeat_ttl(self, job: Job) -> int:
        return self.lease


def runnable_queues(shared: Services, plugin_versions: set[str]) -> list[Queue]:
    """Return the queues of runs that these plug-ins can carry out, longest waiting first."""
    if not plugin_versions:
        return shared.jobs.run_queues
    with shared.sessions.read() as session:
        queued = in_order(session)
    able = [run for run in queued if plugin_versions.issuperset(run.plugin_versions or ())]
    queues = [shared.jobs.run_queue(run.plugin_versions, run.sweep is not None) for run in able]
    return list({queue.name: queue for queue in (*queues, *shared.jobs.run_queues)}.values())


def supervise(settings: Settings, index: int) -> None:
    """Run the worker of this number on this machine until it has to stop."""
    shared = services.connect(settings)
    name = f"{socket.gethostname()}-{os.getpid()}"
    found = device.find(index, settings.workers)
    if found.threads:
        device.pin(found.threads)
    lease = max(SHORTEST_LEASE, round(settings.lease))
    worker = Supervisor(
        shared.jobs.run_queues, name, worker_ttl=lease, serializer=JSONSerializer
    )
    worker.services, worker.lease, worker.environment = shared, lease, found.environment
    plugins = PluginWatcher(settings, settings.lease / HEARTBEATS_PER_LEASE)
    worker.heartbeats = Heartbeats(shared.sessions, name, found, settings.lease, plugins)
    handle_signals(worker.stop_job, interrupt=True)
    log.info("Worker %s on %s", name, found.name)
    worker.heartbeats.start()
    plugins.start()
    loop.serve(worker, lambda: runnable_queues(shared, plugins.report.plugin_versions))
    plugins.end()
    with suppress(SQLAlchemyError):
        worker.heartbeats.end()
    shared.close()


if __name__ == "__main__":
    log_to_stderr()
    supervise(Settings(), int(sys.argv[1]) if len(sys.argv) > 1 else 0)
