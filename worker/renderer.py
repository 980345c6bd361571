"""`python -m worker.renderer [auditor]`: make renderings in a process that stays warm.

The auditor makes audits in a process of its own, so that replays need not wait for them. It
imports the engine for its first audit; until then it needs little memory.
"""

import os
import socket
import sys
from uuid import uuid4

from rq import Queue
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from server.core import logs
from server.queue.jobs import Jobs
from server.services.services import connect
from server.settings import Settings

from . import loop
from .jobs import prepare_once
from .process_setup import handle_signals
from .readiness import StoreCheck

WORKER_TTL = 120
"""Seconds without a report after which Redis forgets a renderer."""
RETRIED = "retried"
"""Marks a job that is tried a second time."""


def retry_interrupted(jobs: Jobs, queue: Queue) -> None:
    """Requeue the jobs during which a renderer died; give up at the second time."""
    for job_id in queue.started_job_registry.get_job_ids(cleanup=False):
        job = jobs.find(job_id)
        if job and job.meta.get(RETRIED):
            jobs.give_up(
                job, "it ended the renderer twice; it may need more memory than there is"
            )
        elif job:
            jobs.render(*job.args, meta={RETRIED: True})


def serve_queue(name: str) -> None:
    """Make the renderings of a queue until asked to stop."""
    # Renderings need little of a GPU that belongs to a worker.
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    settings = Settings()
    logs.set_up(settings)
    handle_signals(interrupt=True)
    if name == "renderer":
        prepare_once()
    services = connect(settings)
    queue = services.jobs.audits if name == "auditor" else services.jobs.renderings
    with loop.logging_outages():
        retry_interrupted(services.jobs, queue)
    unique = f"{name}-{socket.gethostname()}-{uuid4().hex[:8]}"
    logs.bind(worker=unique)
    worker = SimpleWorker([queue], unique, serializer=JSONSerializer, worker_ttl=WORKER_TTL)
    loop.serve(worker, may_work=StoreCheck(services).is_good)
    services.close()


if __name__ == "__main__":
    serve_queue(*sys.argv[1:] or ["renderer"])
