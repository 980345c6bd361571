"""`python -m microcosmos_worker.renderer [auditor]`: make renderings in a warm process.

The auditor makes audits in a process of its own, so that replays need not wait for them. It
imports the engine for its first audit; until then it needs little memory.
"""

import os
import socket
import sys
from threading import Event, Thread
from uuid import uuid4

from rq import Queue
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from microcosmos_server.core import logs
from microcosmos_server.core.processes import note_stop_signals
from microcosmos_server.queue.jobs import FIRST_JOB, Jobs
from microcosmos_server.services.services import connect
from microcosmos_server.settings import from_environment

from . import loop
from .jobs import prepare_job
from .readiness import InstallationCheck

WORKER_TTL = 120
"""Seconds without a report after which Redis forgets a renderer."""
RETRIED = "retried"
"""Marks a job that is tried a second time."""
STOPPED = "stopped"
"""Marks a job during which its renderer was asked to stop."""


def retry_interrupted(jobs: Jobs, queue: Queue) -> None:
    """Requeue the jobs during which a renderer died; give up at the second time."""
    for job_id in queue.started_job_registry.get_job_ids(cleanup=False):
        job = jobs.find(job_id)
        stopped = job and job.meta.get(STOPPED)
        if job and job.meta.get(RETRIED) and not stopped:
            jobs.give_up(
                job, "it ended the renderer twice; it may need more memory than there is"
            )
        elif job and job.func_name == FIRST_JOB:
            jobs.remove(job_id)  # The page that waits for it asks again.
        elif job:
            jobs.render(*job.args, meta=None if stopped else {RETRIED: True})


def mark_stopped(jobs: Jobs, queue: Queue) -> None:
    """Mark the jobs in progress: they may take longer than a stop waits for them."""
    for job_id in queue.started_job_registry.get_job_ids(cleanup=False):
        if job := jobs.find(job_id):
            job.meta[STOPPED] = True
            job.save_meta()
            if not jobs.redis.hexists(job.key, "created_at"):  # It has ended meanwhile.
                jobs.redis.delete(job.key)


def serve_queue(name: str) -> None:
    """Make the renderings of a queue until asked to stop."""
    # Renderings need little of a GPU that belongs to a worker.
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    settings = from_environment()
    logs.set_up(settings)
    stopping = Event()
    note_stop_signals(stopping.set, interrupt=True)
    if name == "renderer":
        prepare_job()
    # Waiting for a job blocks for a while, and nobody waits for this process itself.
    services = connect(settings, patience=loop.DEQUEUE_SECONDS + 4.0)
    queue = services.jobs.audits if name == "auditor" else services.jobs.renderings
    while not stopping.is_set():
        with loop.logging_outages():
            retry_interrupted(services.jobs, queue)
            break
    # A thread, since the signal may come in the midst of another talk with Redis.
    Thread(target=_mark_at_stop, args=(stopping, services.jobs, queue), daemon=True).start()
    unique = f"{name}-{socket.gethostname()}-{uuid4().hex[:8]}"
    logs.bind(worker=unique)
    worker = SimpleWorker([queue], unique, serializer=JSONSerializer, worker_ttl=WORKER_TTL)
    loop.serve(worker, may_work=InstallationCheck(services).is_good)
    services.close()


def _mark_at_stop(stopping: Event, jobs: Jobs, queue: Queue) -> None:
    stopping.wait()
    with loop.logging_outages():
        mark_stopped(jobs, queue)


if __name__ == "__main__":
    serve_queue(*sys.argv[1:] or ["renderer"])
