"""The queues: messages that a run or a replay is to be made. The truth is in SQL."""

import re
from contextlib import suppress
from typing import Any
from uuid import UUID

from redis import Redis
from redis.backoff import ExponentialBackoff
from redis.retry import Retry
from rq import Queue
from rq.exceptions import NoSuchJobError
from rq.job import Job, JobStatus
from rq.registry import clean_registries
from rq.results import Result
from rq.serializers import JSONSerializer

EVOLVE = "worker.jobs.evolve"
RENDER = "worker.jobs.render"
FAILURE_KEPT = 60
"""Seconds for which a failed rendering is remembered, before it may be tried again."""


def open_redis(url: str) -> Redis:
    """A client that gives up soon, so that nobody waits long for a Redis that is gone."""
    retry = Retry(ExponentialBackoff(cap=0.5), 2)
    return Redis.from_url(url, socket_timeout=5, socket_connect_timeout=2, retry=retry)


class Jobs:
    """The queues `runs` and `replays`, under a prefix."""

    def __init__(self, redis: Redis, prefix: str):
        self.redis = redis
        self.slug = re.sub(r"[^\w-]", "-", prefix)
        self.runs = Queue(f"{prefix}runs", connection=redis, serializer=JSONSerializer)
        self.replays = Queue(f"{prefix}replays", connection=redis, serializer=JSONSerializer)

    def evolve(self, run_id: UUID) -> None:
        """Ask for a run to be computed, in place of any earlier request."""
        self.forget(str(run_id))
        self.runs.enqueue(
            EVOLVE,
            str(run_id),
            job_id=str(run_id),
            job_timeout=-1,
            result_ttl=0,
            failure_ttl=3600,
        )

    def render(self, creature: str, meta: dict[str, Any] | None = None) -> None:
        """Ask for a replay to be made."""
        job_id = self.replay_id(creature)
        self.forget(job_id)
        self.replays.enqueue(
            RENDER,
            creature,
            job_id=job_id,
            job_timeout=600,
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

    def replay_id(self, creature: str) -> str:
        """All installations know the same creatures, but each has its own jobs."""
        return f"{self.slug}replay-{creature}"

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
            job.delete()

    def runs_at_hand(self) -> set[str]:
        """Jobs of runs that wait in the queue or that a worker has taken."""
        waiting = self.runs.get_job_ids()
        return {*waiting, *self.runs.started_job_registry.get_job_ids(cleanup=False)}

    def clean(self) -> None:
        """Drop jobs whose worker has died; idle workers do it too, but none may be idle."""
        for queue in (self.runs, self.replays):
            clean_registries(queue)
