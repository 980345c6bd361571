"""Make renderings, in one long-lived process: its compiled programs stay warm."""

import os
import socket
from collections.abc import Callable
from operator import attrgetter
from uuid import uuid4

from rq import Queue
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from server.queue.jobs import Jobs
from server.services.services import connect
from server.settings import Settings

from . import loop
from .jobs import prepared
from .process_setup import listen, log_to_stderr

WORKER_TTL = 120
"""Seconds without a report after which Redis forgets a renderer."""
RETRIED = "retried"
"""Marks a job that is tried a second time."""


def retry_interrupted(jobs: Jobs, queue: Queue) -> None:
    """Requeue once each job during which a renderer died."""
    for job_id in queue.started_job_registry.get_job_ids(cleanup=False):
        job = jobs.find(job_id)
        if job and job.meta.get(RETRIED):
            jobs.give_up(
                job, "it ended the renderer twice; it may need more memory than there is"
            )
        elif job:
            jobs.render(*job.args, meta={RETRIED: True})


def serve_queue(
    name: str, queue_of: Callable[[Jobs], Queue], before: Callable[[], None] = lambda: None
) -> None:
    """Make the renderings of a queue until asked to stop; call `before` first."""
    # Renderings need little of a GPU that belongs to a worker.
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    listen(interrupt=True)
    before()
    services = connect(Settings())
    queue = queue_of(services.jobs)
    with loop.logging_outages():
        retry_interrupted(services.jobs, queue)
    unique = f"{name}-{socket.gethostname()}-{uuid4().hex[:8]}"
    loop.serve(SimpleWorker([queue], unique, serializer=JSONSerializer, worker_ttl=WORKER_TTL))
    services.close()


if __name__ == "__main__":
    log_to_stderr()
    serve_queue("renderer", attrgetter("renderings"), prepared)
