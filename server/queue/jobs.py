"""The queues: messages that a run or a rendering is to be made. The truth is in SQL."""

import logging
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from hashlib import sha256
from typing import Any
from uuid import UUID

from redis import Redis, RedisError
from redis.backoff import ExponentialBackoff
from redis.retry import Retry
from rq import Queue
from rq.exceptions import InvalidJobOperation, NoSuchJobError
from rq.job import Job, JobStatus
from rq.registry import clean_registries
from rq.results import Result
from rq.serializers import JSONSerializer
from rq.utils import as_text

from ..tables import AUDIT, MEASUREMENT, REPLAY, Run

log = logging.getLogger(__name__)

EVOLVE = "worker.job_process.main"
RENDER = "worker.jobs.render"
OWN = "-own-"
"""Begins the second part of names of queues that only some workers listen to."""
TIMEOUTS = {AUDIT: 3600, MEASUREMENT: 3600}
RENDER_SECONDS = 600
"""How long a rendering may take, those of `TIMEOUTS` aside."""
KEPT: Any = {"result_ttl": 0, "failure_ttl": 3600}
"""Seconds for which Redis keeps what became of a run's job."""
FAILURE_KEPT = 60
"""Seconds for which a failed rendering is remembered, before it may be tried again."""


def open_redis(url: str) -> Redis:
    """A client that gives up soon, so that nobody waits long for a Redis that is gone."""
    retry = Retry(ExponentialBackoff(cap=0.5), 2)
    return Redis.from_url(url, socket_timeout=5, socket_connect_timeout=2, retry=retry)


class Jobs:
    """The queues `runs`, `sweeps`, `renderings` and `audits`, under a prefix."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.slug = re.sub(r"[^\w-]", "-", prefix)
        self.runs, self.sweeps, self.renderings, self.audits = (
            self._queue(f"{prefix}{name}")
            for name in ("runs", "sweeps", "renderings", "audits")
        )

    @property
    def evolving(self) -> list[Queue]:
        """Where runs wait that every worker can carry out, in the order in which workers look.

        Runs of sweeps wait aside, so that a hundred of them hold up nobody's single run.
        """
        return [self.runs, self.sweeps]

    def evolve(
        self, run_id: UUID, of_sweep: bool = False, plugin_versions: Sequence[str] | None = None
    ) -> None:
        """Ask for a run to be computed, in place of any earlier request."""
        self.forget(str(run_id))
        queue = self.evolving_with(plugin_versions, of_sweep)
        queue.enqueue(EVOLVE, str(run_id), job_id=str(run_id), job_timeout=-1, **KEPT)

    def enqueue(self, runs: Iterable[Any]) -> None:
        """Enqueue runs by `id`, `sweep` and `plugin_versions`.

        Where Redis does not answer they stay queued in SQL, and the reconciler enqueues them.
        """
        try:
            for run in runs:
                self.evolve(run.id, run.sweep is not None, run.plugin_versions)
        except RedisError as error:
            log.warning("runs stay queued until Redis answers: %s", error)

    def evolve_new(self, runs: Iterable[Run]) -> None:
        """Ask for runs of a sweep that were never asked for, in their order."""
        jobs: dict[Queue, list[Any]] = {}
        for run in runs:
            queue, name = self.evolving_with(run.plugin_versions, of_sweep=True), str(run.id)
            job = Queue.prepare_data(EVOLVE, (name,), job_id=name, timeout=-1, **KEPT)
            jobs.setdefault(queue, []).append(job)
        for queue, some in jobs.items():
            queue.enqueue_many(some)

    def render(
        self,
        creature: str,
        kind: str = REPLAY,
        meta: dict[str, Any] | None = None,
        *,
        patient: bool = False,
    ) -> None:
        """Ask for a rendering to be made.

        Replays come first, unless who asks is `patient`: somebody waits to watch. What takes
        minutes has a queue of its own.
        """
        job_id = self.rendering_id(creature, kind)
        self.forget(job_id)
        queue = self.audits if kind in TIMEOUTS else self.renderings
        queue.enqueue(
            RENDER,
            creature,
            kind,
            job_id=job_id,
            at_front=kind == REPLAY and not patient,
            job_timeout=TIMEOUTS.get(kind, RENDER_SECONDS),
            result_ttl=0,
            failure_ttl=FAILURE_KEPT,
            meta=meta,
        )

    def give_up(self, job: Job, reason: str) -> None:
        """Count a job as failed that its worker can say nothing about any more."""
        self.forget(job.id)
        job.set_status(JobStatus.FAILED)
        with self.redis.pipeline() as pipeline:
            job.failed_job_registry.add(job, FAILURE_KEPT, reason, pipeline)
            Result.create_failure(job, FAILURE_KEPT, reason, pipeline=pipeline)
            pipeline.execute()

    def rendering_id(self, creature: str, kind: str = REPLAY) -> str:
        """All installations know the same creatures, but each has its own jobs."""
        return f"{self.slug}{kind.replace('.', '-')}-{creature}"

    def find(self, job_id: str) -> Job | None:
        with suppress(NoSuchJobError):
            return Job.fetch(job_id, connection=self.redis, serializer=JSONSerializer)
        return None

    def forget(self, job_id: str) -> None:
        """Remove a job with every trace of its executions.

        RQ's own way raises where a worker died: what it knows of an execution expires
        before the entry that leads there.
        """
        if job := self.find(job_id):
            executions = job.execution_registry
            for execution in executions.get_execution_ids():
                self.redis.zrem(job.started_job_registry.key, f"{job_id}:{execution}")
            self.redis.delete(executions.key)
            # A job that ends at this moment deletes itself.
            with suppress(InvalidJobOperation):
                job.delete()

    def evolving_with(self, plugin_versions: Sequence[str] | None, of_sweep: bool) -> Queue:
        """Where runs wait that need these versions of users' own modules: only workers that
        have them listen."""
        queue = self.sweeps if of_sweep else self.runs
        if not plugin_versions:
            return queue
        name = sha256("".join(sorted(plugin_versions)).encode()).hexdigest()[:16]
        return self._queue(f"{queue.name}{OWN}{name}")

    def evolving_anywhere(self) -> list[Queue]:
        """All queues of runs that Redis knows."""
        found = [as_text(name) for name in self.redis.smembers(Queue.redis_queues_keys)]  # pyright: ignore
        names = [name.removeprefix(Queue.redis_queue_namespace_prefix) for name in found]
        ours = tuple(queue.name + OWN for queue in self.evolving)
        own = sorted(name for name in names if name.startswith(ours))
        return [*self.evolving, *map(self._queue, own)]

    def _queue(self, name: str) -> Queue:
        return Queue(name, connection=self.redis, serializer=JSONSerializer)

    def runs_at_hand(self) -> set[str]:
        """Jobs of runs that wait in the queue or that a worker has taken."""
        found: set[str] = set()
        for queue in self.evolving_anywhere():
            started = queue.started_job_registry.get_job_ids(cleanup=False)
            found |= {*queue.get_job_ids(), *started}
        return found

    def clean(self) -> None:
        """Drop jobs whose worker has died; idle workers do it too, but none may be idle."""
        for queue in (*self.evolving_anywhere(), self.renderings, self.audits):
            clean_registries(queue)
