"""Makes renderings, in one long-lived process: its compiled programs stay warm."""

import os
import socket
from collections.abc import Callable
from operator import attrgetter
from uuid import uuid4

from rq import Queue
from rq.job import Job
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from server.queue.jobs import Jobs
from server.services.services import connect
from server.settings import Settings

from . import log, loop, stop
from .jobs import prepared

SILENCE = 120
"""Seconds after which a renderer without work counts as dead."""
MARGIN = 60
"""Seconds beyond a rendering's time after which whoever makes it counts as dead."""
AGAIN = "again"
"""Marks a job that is tried a second time."""


class Renderer(SimpleWorker):
    """RQ's worker without processes of its own, which says nothing while it renders."""

    def get_heartbeat_ttl(self, job: Job) -> int:
        """The whole of what it may take, since nothing beats meanwhile."""
        return int(job.timeout or 0) + MARGIN


def take_up(jobs: Jobs, queue: Queue) -> None:
    """Ask again, once, for what of a queue a renderer was making when it died."""
    for job_id in queue.started_job_registry.get_job_ids(cleanup=False):
        job = jobs.find(job_id)
        if job and job.meta.get(AGAIN):
            jobs.give_up(job, "it has ended the renderer twice, perhaps for want of memory")
        elif job:
            jobs.render(*job.args, meta={AGAIN: True})


def serve(
    name: str, queue_of: Callable[[Jobs], Queue], before: Callable[[], None] = lambda: None
) -> None:
    """Render what a queue asks for until told to stop; `before` the first one is asked for."""
    # Its few arrays need little of a GPU that belongs to a worker.
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    stop.listen(interrupt=True)
    before()
    services = connect(Settings())
    queue = queue_of(services.jobs)
    with loop.surviving():
        take_up(services.jobs, queue)
    unique = f"{name}-{socket.gethostname()}-{uuid4().hex[:8]}"
    loop.serve(Renderer([queue], unique, serializer=JSONSerializer, worker_ttl=SILENCE))
    services.close()


def main() -> None:
    """Make all renderings but audits; the engine is there before the first one is wanted."""
    serve("renderer", attrgetter("renderings"), prepared)


if __name__ == "__main__":
    log.begin()
    main()
