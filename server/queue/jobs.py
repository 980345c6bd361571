"""Job queues in Redis: requests to compute runs and renderings. SQL holds their state."""

import logging
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from hashlib import sha256
from typing import Any

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

from ..tables import AUDIT, MEASUREMENT, REPLAY

log = logging.getLogger(__name__)

RUN_JOB = "worker.job_process.main"
RENDER_JOB = "worker.jobs.render"
PLUGINS_SEPARATOR = "-plugins-"
"""Separator of a queue's name and the hash of the plug-ins that its workers must have."""
TIMEOUTS = {AUDIT: 3600, MEASUREMENT: 3600}
RENDER_SECONDS = 600
"""Time limit of the renderings that `TIMEOUTS` does not name."""
FAILURE_SECONDS = 60
"""Seconds that Redis keeps a failed rendering; then it may be tried again."""
NAMES = ("runs", "sweeps", "renderings", "audits")


def open_redis(url: str) -> Redis:
    """Return a client that stops waiting after a few seconds if Redis does not answer."""
    retry = Retry(ExponentialBackoff(cap=0.5), 2)
    return Redis.from_url(url, socket_timeout=5, socket_connect_timeout=2, retry=retry)


class Jobs:
    """The queues `runs`, `sweeps`, `renderings` and `audits`, under a prefix."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.slug = re.sub(r"[^\w-]", "-", prefix)
        self.runs, self.sweeps, self.renderings, self.audits = (
            self._queue(f"{prefix}{name}") for name in NAMES
        )

    @property
    def run_queues(self) -> list[Queue]:
        """Queues of runs that every worker can compute, in the order in which workers look.

        Sweeps have a queue of their own, so that a hundred runs do not delay a single run.
        """
        return [self.runs, self.sweeps]

    def enqueue(self, runs: Iterable[Any]) -> None:
        """Enqueue runs, given by `id`, `sweep` and `plugin_versions`, in their order.

        A job replaces any earlier one of its run. Where Redis does not answer the runs stay
        queued in SQL, and the reconciler enqueues them.
        """
        names: dict[Queue, list[str]] = {}
        for run in runs:
            queue = self.run_queue(run.plugin_versions, run.sweep is not None)
            names.setdefault(queue, []).append(str(run.id))
        try:
            for queue, some in names.items():
                self._replace(queue, some)
        except RedisError as error:
            log.warning("runs stay queued until Redis answers: %s", error)

    def _replace(self, queue: Queue, names: Sequence[str]) -> None:
        for job in Job.fetch_many(names, self.redis, JSONSerializer):
            if job:
                self._remove(job)
        data = [
            Queue.prepare_data(
                RUN_JOB, (name,), job_id=name, timeout=-1, result_ttl=0, failure_ttl=3600
            )
            for name in names
        ]
        with self.redis.pipeline() as pipeline:
            # In one transaction: another process may enqueue the same run at the same time.
            for name in names:
                pipeline.lrem(queue.key, 0, name)
            queue.enqueue_many(data, pipeline=pipeline)
            pipeline.execute()

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

    def run_queue(self, plugin_versions: Sequence[str] | None, of_sweep: bool) -> Queue:
        """Return the queue of runs that need these plug-ins: workers that have them listen."""
        queue = self.sweeps if of_sweep else self.runs
        if not plugin_versions:
            return queue
        name = sha256("".join(sorted(plugin_versions)).encode()).hexdigest()[:16]
        return self._queue(f"{queue.name}{PLUGINS_SEPARATOR}{name}")

    def all_run_queues(self) -> list[Queue]:
        """Return all queues of runs that Redis knows."""
        found = [as_text(name) for name in self.redis.smembers(Queue.redis_queues_keys)]  # pyright: ignore
        names = [name.removeprefix(Queue.redis_queue_namespace_prefix) for name in found]
        ours = tuple(queue.name + PLUGINS_SEPARATOR for queue in self.run_queues)
        special = sorted(name for name in names if name.startswith(ours))
        return [*self.run_queues, *map(self._queue, special)]

    def _all(self) -> list[Queue]:
        return [*self.all_run_queues(), self.renderings, self.audits]

    def _queue(self, name: str) -> Queue:
        return Queue(name, connection=self.redis, serializer=JSONSerializer)

    def runs_with_job(self) -> set[str]:
        """Return the ids of runs that wait in a queue or that a worker has taken."""
        found: set[str] = set()
        for queue in self.all_run_queues():
            started = queue.started_job_registry.get_job_ids(cleanup=False)
            found |= {*queue.get_job_ids(), *started}
        return found

    def lengths(self) -> dict[str, int]:
        """Return the number of jobs that wait, by name; queues with plug-ins are added up."""
        lengths: dict[str, int] = dict.fromkeys(NAMES, 0)
        for queue in self._all():
            kind = next(one for one in NAMES if queue.name.startswith(getattr(self, one).name))
            lengths[kind] += len(queue)
        return lengths

    def clean(self) -> None:
        """Drop jobs whose worker has died. Idle workers do it too, but none may be idle."""
        for queue in self._all():
            clean_registries(queue)
