"""The process of one job: `python -m worker.job_process WORKER QUEUE JOB EXECUTION PARENT`."""

import os
import signal
import sys

from rq.executions import Execution
from rq.job import Job
from rq.queue import Queue
from rq.serializers import JSONSerializer
from rq.worker import Worker

from server.core.processes import die_with_parent
from server.queue.jobs import open_redis
from server.settings import Settings

from . import log, stop
from .jobs import WORKER


class JobProcess(Worker):
    """The side of RQ's worker that performs the job."""

    def setup_work_horse_signals(self) -> None:
        stop.listen()


NICE = 10
"""People wait for the page and for replays; nobody waits for the next block."""


def main(worker: str, queue: str, job: str, execution: str, parent: str) -> None:
    """Perform the job and exit; if the supervisor dies, so do we, wherever we are."""
    die_with_parent(int(parent), signal.SIGKILL)
    stop.listen()
    os.nice(NICE)
    os.environ[WORKER] = worker
    connection = open_redis(Settings().redis_url)
    key = JobProcess.redis_worker_namespace_prefix + worker
    process = JobProcess.find_by_key(key, connection, serializer=JSONSerializer)
    if process is None:
        sys.exit(f"Worker {worker} is not in Redis any more.")
    process.execution = Execution.fetch(execution, job, connection)
    process.main_work_horse(
        Job.fetch(job, connection, serializer=JSONSerializer),
        Queue(queue, connection, serializer=JSONSerializer),
    )


if __name__ == "__main__":
    log.begin()
    main(*sys.argv[1:])
