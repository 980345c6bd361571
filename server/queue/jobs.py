"""Job queues in Redis: requests to compute renderings."""

import re
from contextlib import suppress
from typing import Any, cast

from redis import Redis
from redis.backoff import ExponentialBackoff
from redis.retry import Retry
from rq import Queue
from rq.exceptions import InvalidJobOperation, NoSuchJobError
from rq.job import Job, JobStatus
from rq.registry import clean_registries
from rq.results import Result
from rq.serializers import JSONSerializer

from ..tables import AUDIT, MEASUREMENT, REPLAY

RENDER_JOB = "worker.jobs.render"
FIRST, FIRST_JOB = "first", "worker.jobs.first_creature"
"""The inputs of the evaluation of a first creature of a run that may never be queued."""
FIRST_TTL = 600
"""Seconds that Redis keeps them: nothing else does."""
TIMEOUTS = {AUDIT: 3600, MEASUREMENT: 3600}
RENDER_SECONDS = 600
"""Time limit of the renderings that `TIMEOUTS` does not name."""
FAILURE_SECONDS = 60
"""Seconds that Redis keeps a failed rendering; then it may be tried again."""
NAMES = ("renderings", "audits")


def open_redis(url: str) -> Redis:
    """Return a client that stops waiting after a few seconds if Redis does not answer."""
    retry = Retry(ExponentialBackoff(cap=0.5), 2)
    return Redis.from_url(url, socket_timeout=5, socket_connect_timeout=2, retry=retry)


class Jobs:
    """The queues `renderings` and `audits`, under a prefix."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.slug = re.sub(r"[^\w-]", "-", prefix)
        self.renderings, self.audits = (self._queue(f"{prefix}{name}") for name in NAMES)

    def render(
        self,
        creature: str,
        kind: str = REPLAY,
        meta: dict[str, Any] | None = None,
        *,
        anonymous: bool = False,
    ) -> None:
        """Enqueue a rendering. Replays go first, unless the holder of a share orders them."""
        job_id = self.rendering_id(creature, kind)
        self.remove(job_id)
        queue = self.audits if kind in TIMEOUTS else self.renderings
        queue.enqueue(
            RENDER_JOB,
            creature,
            kind,
            job_id=job_id,
            at_front=kind == REPLAY and not anonymous,
            job_timeout=TIMEOUTS.get(kind, RENDER_SECONDS),
            result_ttl=0,
            failure_ttl=FAILURE_SECONDS,
            meta=meta,
        )

    def order_first(self, name: str, spec: dict[str, Any], number: int) -> None:
        """Enqueue the making of a first creature of a spec, before other renderings."""
        job_id = self.rendering_id(name, FIRST)
        self.remove(job_id)
        self.renderings.enqueue(
            FIRST_JOB,
            name,
            spec,
            number,
            job_id=job_id,
            at_front=True,
            job_timeout=RENDER_SECONDS,
            result_ttl=0,
            failure_ttl=FAILURE_SECONDS,
        )

    def keep_first(self, name: str, inputs: bytes) -> None:
        self.redis.set(self._first_key(name), inputs, ex=FIRST_TTL)

    def first(self, name: str) -> bytes | None:
        """Return the inputs of the evaluation of a first creature; None if none are kept."""
        return cast(bytes | None, self.redis.get(self._first_key(name)))

    def _first_key(self, name: str) -> str:
        return f"{self.slug}{FIRST}:{name}"

    def give_up(self, job: Job, reason: str) -> None:
        """Mark a job as failed whose worker has died."""
        self._remove(job)
        job.set_status(JobStatus.FAILED)
        with self.redis.pipeline() as pipeline:
            job.failed_job_registry.add(job, FAILURE_SECONDS, reason, pipeline)
            Result.create_failure(job, FAILURE_SECONDS, reason, pipeline=pipeline)
            pipeline.execute()

    def rendering_id(self, creature: str, kind: str = REPLAY) -> str:
        """Return the id of a job; the prefix separates installations that share a Redis."""
        return f"{self.slug}{kind.replace('.', '-')}-{creature}"

    def find(self, job_id: str) -> Job | None:
        with suppress(NoSuchJobError):
            return Job.fetch(job_id, connection=self.redis, serializer=JSONSerializer)
        return None

    def remove(self, job_id: str) -> None:
        if job := self.find(job_id):
            self._remove(job)

    def _remove(self, job: Job) -> None:
        """Remove a job with every trace of its executions.

        RQ's own method raises if a worker died: the data of an execution expires before its
        entry in the registry.
        """
        executions = job.execution_registry
        for execution in executions.get_execution_ids():
            self.redis.zrem(job.started_job_registry.key, f"{job.id}:{execution}")
        self.redis.delete(executions.key)
        with suppress(InvalidJobOperation):  # A job that ends now deletes itself.
            job.delete()

    def _queue(self, name: str) -> Queue:
        return Queue(name, connection=self.redis, serializer=JSONSerializer)

    def lengths(self) -> dict[str, int]:
        """Return the number of jobs that wait, by name."""
        return {name: len(getattr(self, name)) for name in NAMES}

    def clean(self) -> None:
        """Drop jobs whose worker has died. Idle workers do it too, but none may be idle."""
        for name in NAMES:
            clean_registries(getattr(self, name))
