"""Makes replays, in one long-lived process: its compiled programs stay warm."""

import os
import socket
from uuid import uuid4

from rq.job import Job
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from microcosmos.device import prepare
from server.queue import Jobs
from server.services import connect
from server.settings import Settings

from . import log, loop, stop

SILENCE = 120
"""Seconds after which a renderer without work counts as dead."""
MARGIN = 60
"""Seconds beyond a replay's time after which whoever makes it counts as dead."""
AGAIN = "again"
"""Marks a job that is tried a second time."""


class Renderer(SimpleWorker):
    """RQ's worker without processes of its own, which says nothing while it renders."""

    def get_heartbeat_ttl(self, job: Job) -> int:
        """The whole of what it may take, since nothing beats meanwhile."""
        return int(job.timeout or 0) + MARGIN


def take_up(jobs: Jobs) -> None:
    """Ask again, once, for the replays that a renderer was making when it died."""
    for job_id in jobs.replays.started_job_registry.get_job_ids(cleanup=False):
        job = jobs.find(job_id)
        if job and job.meta.get(AGAIN):
            jobs.give_up(job, "it has ended the renderer twice, perhaps for want of memory")
        elif job:
            jobs.render(*job.args, meta={AGAIN: True})


def main() -> None:
    """Render until told to stop."""
    # Its few arrays need little of a GPU that belongs to a worker.
    os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
    stop.listen(interrupt=True)
    prepare()
    services = connect(Settings())
    name = f"renderer-{socket.gethostname()}-{uuid4().hex[:8]}"
    with loop.surviving():
        take_up(services.jobs)
    loop.serve(
        Renderer([services.jobs.replays], name, serializer=JSONSerializer, worker_ttl=SILENCE)
    )
    services.close()


if __name__ == "__main__":
    log.begin()
    main()
