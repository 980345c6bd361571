"""Take one job after another from queues, in place of RQ's `work`.

`work` ends at some errors of Redis, and drops a job if a signal arrives just after it was taken
(tests/worker/test_loop.py).
"""

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from redis.exceptions import RedisError
from rq.exceptions import DequeueTimeout
from rq.queue import Queue
from rq.worker import BaseWorker
from sqlalchemy.exc import SQLAlchemyError

from microcosmos_server.core.processes import stop_requested

DEQUEUE_SECONDS = 1
"""Longest time before an idle worker notices a request to stop."""
CLEAN_SECONDS = 30.0
"""Seconds after which jobs are looked for that were lost while they were taken."""
PAUSE_SECONDS = 1.0
"""Pause after an error of Redis or the database."""

log = logging.getLogger(__name__)


def serve(worker: BaseWorker, may_work: Callable[[], bool] = lambda: True) -> None:
    """Carry out jobs until the process has to stop, as long as it may work."""
    cleaned = time.monotonic()
    while not stop_requested():
        with logging_outages():
            if time.monotonic() > cleaned + CLEAN_SECONDS:
                cleaned = time.monotonic()
                end_lost(worker)
            if may_work():
                take_one(worker)
            else:
                time.sleep(PAUSE_SECONDS)
    with suppress(RedisError):
        worker.register_death()


def take_one(worker: BaseWorker) -> None:
    """Wait a moment for a job and carry it out."""
    if not worker.connection.exists(worker.key):  # At the start, or when Redis was emptied.
        worker.register_birth()
    worker.heartbeat()
    with suppress(DequeueTimeout):
        taken = Queue.dequeue_any(
            worker.queues, DEQUEUE_SECONDS, worker.connection, serializer=worker.serializer
        )
        if taken:
            worker.execute_job(*taken)


def end_lost(worker: BaseWorker) -> None:
    """Fail the jobs that somebody has taken and, for more than a minute, not begun.

    Redis has moved them when its answer is lost or a process dies. They would count as queued
    for ever, and so be asked for in vain.
    """
    for queue in worker.queues:
        queue.intermediate_queue.cleanup(worker, queue)


@contextmanager
def logging_outages() -> Iterator[None]:
    """Log errors of Redis and the database, and go on: SQL holds the state of all runs."""
    try:
        yield
    except (RedisError, SQLAlchemyError) as error:
        log.warning("Continuing after %s: %s", type(error).__name__, error)
        time.sleep(PAUSE_SECONDS)
