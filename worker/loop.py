"""Takes one job after the other from a queue; no error of Redis ends it.

RQ's own loop ends at some errors, and drops a job where a signal arrives just after it was
taken.
"""

import logging
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

from redis.exceptions import RedisError
from rq.exceptions import DequeueTimeout
from rq.queue import Queue
from rq.worker import WorkerStatus
from rq.worker.base import BaseWorker
from sqlalchemy.exc import SQLAlchemyError

from . import stop

DEQUEUE_SECONDS = 1
"""How long a wish to stop can go unnoticed while the queue is empty."""
PAUSE_SECONDS = 1.0
"""Between two tries where Redis refuses."""

log = logging.getLogger(__name__)


def serve(worker: BaseWorker, queues: Callable[[], list[Queue]] | None = None) -> None:
    """Carry out jobs until this process is told to stop; `queues` says of which now."""
    while not stop.requested():
        with surviving():
            if queues:
                worker.queues = queues()
            take_one(worker)
    with suppress(RedisError):
        worker.register_death()


def take_one(worker: BaseWorker) -> None:
    """Wait a moment for a job and carry it out."""
    if not worker.connection.exists(worker.key):  # At first, or Redis was emptied.
        worker.register_birth()
    worker.set_state(WorkerStatus.IDLE)
    worker.heartbeat()
    with suppress(DequeueTimeout):
        taken = Queue.dequeue_any(
            worker.queues, DEQUEUE_SECONDS, worker.connection, serializer=worker.serializer
        )
        if taken:
            worker.execute_job(*taken)


@contextmanager
def surviving() -> Iterator[None]:
    """An outage ends by itself: SQL knows about the runs, and what is left is done later."""
    try:
        yield
    except (RedisError, SQLAlchemyError) as error:
        log.warning("Going on after %s: %s", type(error).__name__, error)
        time.sleep(PAUSE_SECONDS)
