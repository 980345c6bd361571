"""Job queues in Redis: requests to compute renderings."""

import re
from contextlib import suppress
from typing import Any, NamedTuple, cast

from redis import ConnectionError, Redis
from redis.backoff import NoBackoff
from redis.retry import Retry
from rq import Queue
from rq.exceptions import InvalidJobOperation, NoSuchJobError
from rq.job import Job, JobStatus
from rq.registry import clean_registries
from rq.results import Result
from rq.serializers import JSONSerializer

from microcosmos.archive import columns
from microcosmos.viz.replay_file import REPLAY_VERSION

from ..tables import AUDIT, EVALUATION, GIF, LOOP, MEASUREMENT, MP4, PREVIEW, REPLAY, STRIP

RENDER_JOB = "microcosmos_worker.jobs.render"
FIRST, FIRST_JOB = "first", "microcosmos_worker.jobs.first_creature"
"""The job that prepares a creature of a spec's first generation; it queues no run."""
FIRST_TTL = 600
"""Seconds for which Redis keeps the prepared inputs, the only copy."""
RENDER_SECONDS, AUDIT_SECONDS = 600, 3600
"""Time limits of a job in each of the two queues."""
FAILURE_SECONDS = 60
"""Seconds that Redis keeps a failed rendering; then it may be tried again."""
ANSWER_SECONDS = 1.0
"""Seconds to wait for an answer of Redis: a request, with a thread of the server, waits too."""
REASON = "reason"
"""The key of the cause of a failure in the metadata of a job."""
NAMES = ("renderings", "audits")


class Kind(NamedTuple):
    """A kind of rendering."""

    media_type: str
    noun: str
    ordered: bool = False
    """The auditor makes it once somebody orders it. Others are made at the first request."""
    version: int | None = None
    """The version of the format. A rendering in an earlier one does not count."""


KINDS = {
    REPLAY: Kind("application/octet-stream", "replay", version=REPLAY_VERSION),
    AUDIT: Kind("application/json", "audit", ordered=True),
    MEASUREMENT: Kind("application/json", "measurement", ordered=True, version=2),
    EVALUATION: Kind(columns.MEDIA_TYPE, "evaluation", version=2),
    STRIP: Kind("image/png", "picture"),
    PREVIEW: Kind("image/png", "picture"),
    GIF: Kind("image/gif", "film"),
    MP4: Kind("video/mp4", "film"),
    LOOP: Kind("video/mp4", "film"),
}
"""The kinds of renderings, by their names in the API."""
ON_REQUEST = tuple(name for name, kind in KINDS.items() if not kind.ordered)


def open_redis(url: str, patience: float = ANSWER_SECONDS) -> Redis:
    """Return a client that waits for some seconds if Redis does not answer."""
    # A broken connection is opened anew: each of the pool breaks when Redis restarts.
    retry = Retry(NoBackoff(), 1, supported_errors=(ConnectionError,))
    return Redis.from_url(
        url, socket_timeout=patience, socket_connect_timeout=patience, retry=retry
    )


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
        # A job of the same id may be left that failed, or whose worker died
        # (tests/server/creatures/test_creatures.py gives a lost order again).
        job_id = self.rendering_id(creature, kind)
        self.remove(job_id)
        ordered = KINDS[kind].ordered
        queue = self.audits if ordered else self.renderings
        queue.enqueue(
            RENDER_JOB,
            creature,
            kind,
            job_id=job_id,
            at_front=kind == REPLAY and not anonymous,
            job_timeout=AUDIT_SECONDS if ordered else RENDER_SECONDS,
            # The store has the rendering: RQ need not keep a result.
            result_ttl=0,
            failure_ttl=FAILURE_SECONDS,
            meta=meta,
        )

    def order_first(self, name: str, spec: dict[str, Any], number: int) -> None:
        """Enqueue a creature of a spec's first generation, ahead of other renderings."""
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
        job.meta[REASON] = reason
        job.save_meta()
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
        # RQ's default serializer is pickle: then writing to Redis would mean running code here.
        return Queue(name, connection=self.redis, serializer=JSONSerializer)

    def lengths(self) -> dict[str, int]:
        """Return the number of jobs that wait, by name."""
        return {name: len(getattr(self, name)) for name in NAMES}

    def clean(self) -> None:
        """Drop jobs whose worker has died. Idle workers do it too, but none may be idle."""
        for name in NAMES:
            clean_registries(getattr(self, name))
