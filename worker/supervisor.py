"""A worker: takes runs from the queue and carries out each in a process of its own; no JAX."""

import logging
import os
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from typing import Any
from uuid import UUID

from rq.job import Job
from rq.queue import Queue
from rq.serializers import JSONSerializer
from rq.worker import SpawnWorker
from sqlalchemy.exc import SQLAlchemyError

from server.attempts.leases import job_died, job_stopped
from server.queue.order import in_order
from server.services import services
from server.services.services import Services
from server.settings import Settings

from . import device, log, loop, plugins, processor, stop
from .pulse import BEATS, Pulse

SHORTEST_LEASE = 2
"""Redis counts in seconds."""
PATIENCE = 18.0
"""Seconds that a job has to end after it was asked to; less than this process itself has."""
LOOK = 1.0
"""At most so often it is seen, while it is to end, whether it has."""

journal = logging.getLogger(__name__)


class Supervisor(SpawnWorker):
    """RQ's worker with short leases, whose job nothing orphans."""

    services: Services
    pulse: Pulse
    lease: int
    environment: dict[str, str]
    asked_at: float | None = None
    """When the job was first asked to stop."""
    cut_short: bool = False
    """Whether it had to be killed since it did not stop."""

    def execute_job(self, job: Job, queue: Queue) -> None:
        """Carry out a run, and see to it that it goes on when its process died."""
        run = UUID(job.id)
        try:
            if not stop.requested():
                self.prepare_execution(job)
                self.fork_work_horse(job, queue)
                self.pulse.watch(run, self.kill_horse)
                self.monitor_work_horse(job, queue)
        finally:
            self.pulse.let_go()
            with loop.surviving():
                self.account_for(run)

    def account_for(self, run: UUID) -> None:
        """Have a run wait again that its job has left without a word."""
        if self.cut_short:
            job_stopped(self.services, run, self.name)
        else:
            job_died(self.services, run, self.name, "the job's process died without a word")

    def fork_work_horse(self, job: Job, queue: Queue) -> None:
        """Start the job's process; nothing secret is among its arguments."""
        assert self.execution is not None
        arguments = (self.name, queue.name, job.id, self.execution.id, str(os.getpid()))
        self._horse = subprocess.Popen(
            [sys.executable, "-m", "worker.job_process", *arguments],
            env=os.environ | self.environment,
            stdin=subprocess.DEVNULL,
            process_group=0,
        )
        self._horse_pid = self._horse.pid
        if stop.requested():  # In between, when there was nobody to pass it on to.
            self.pass_on()

    def monitor_work_horse(self, job: Job, queue: Queue) -> None:
        """Wait for the job's process, keeping its lease in Redis alive."""
        while (code := self._ended()) is None:
            with loop.surviving():
                self.maintain_heartbeats(job)
            self.lose_patience()
        self._horse_pid = 0
        if code:
            journal.warning("Run %s: its process ended with %s", job.id, code)
            with loop.surviving():
                self.handle_job_failure(job, queue, exc_string=f"ended with {code}")

    def _ended(self) -> int | None:
        with suppress(subprocess.TimeoutExpired):
            return self._horse.wait(LOOK if self.asked_at else self.lease / BEATS)
        return None

    def lose_patience(self) -> None:
        """Kill a job that was asked to stop and is in one block for too long."""
        if self.asked_at and time.monotonic() - self.asked_at > PATIENCE:
            self.cut_short = True
            self.kill_horse()

    def kill_horse(self, sig: signal.Signals = signal.SIGKILL) -> None:
        self._horse.send_signal(sig)

    def pass_on(self) -> None:
        """Ask the job to stop: between blocks, with a checkpoint."""
        if self.horse_pid:
            self.asked_at = self.asked_at or time.monotonic()
            self.kill_horse(signal.SIGTERM)

    def heartbeat(self, timeout: int | None = None, pipeline: Any = None) -> None:
        super().heartbeat(self.lease, pipeline)

    def get_heartbeat_ttl(self, job: Job) -> int:
        return self.lease


def own_queues(shared: Services, plugin_versions: set[str]) -> list[Queue]:
    """The queues of runs that can be carried out with these modules of users' own, those
    first whose runs have waited longest."""
    if not plugin_versions:
        return shared.jobs.evolving
    with shared.sessions.read() as session:
        queued = in_order(session)
    able = [run for run in queued if plugin_versions.issuperset(run.plugin_versions or ())]
    queues = [
        shared.jobs.evolving_with(run.plugin_versions, run.sweep is not None) for run in able
    ]
    return list({queue.name: queue for queue in (*queues, *shared.jobs.evolving)}.values())


def supervise(settings: Settings, index: int) -> None:
    """Be the worker with this number on this machine, until told to stop."""
    shared = services.connect(settings)
    name = f"{socket.gethostname()}-{os.getpid()}"
    found = device.find(index, settings.workers)
    if found.threads:
        processor.keep_to(found.threads)
    lease = max(SHORTEST_LEASE, round(settings.lease))
    worker = Supervisor(shared.jobs.evolving, name, worker_ttl=lease, serializer=JSONSerializer)
    worker.services, worker.lease, worker.environment = shared, lease, found.environment
    shelf = plugins.Shelf(settings, settings.lease / BEATS)
    told = lambda: shelf.last  # noqa: E731
    worker.pulse = Pulse(shared.sessions, name, found, settings.lease, told)
    stop.listen(worker.pass_on, interrupt=True)
    journal.info("Worker %s on %s", name, found.name)
    worker.pulse.start()
    shelf.start()
    loop.serve(worker, lambda: own_queues(shared, shelf.last.plugin_versions))
    shelf.end()
    with suppress(SQLAlchemyError):
        worker.pulse.end()
    shared.close()


if __name__ == "__main__":
    log.begin()
    supervise(Settings(), int(sys.argv[1]) if len(sys.argv) > 1 else 0)
