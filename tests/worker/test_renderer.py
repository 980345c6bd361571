"""The renderer after a death."""

import time

import pytest
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from server.renderings.storage import RenderingFailed, order
from worker.renderer import retry_interrupted

CREATURE = "ab" * 32


@pytest.fixture
def begin(services):
    """Takes the order as far as a renderer that dies while it works on it."""

    def take():
        queue = services.jobs.renderings
        renderer = SimpleWorker([queue], serializer=JSONSerializer)
        renderer.register_birth()
        job, _ = queue.dequeue_any([queue], None, services.redis, serializer=JSONSerializer)
        renderer.prepare_execution(job)
        renderer.prepare_job_execution(job)
        renderer.register_death()
        return job

    return take


def test_a_replay_that_ends_the_renderer_twice_is_given_up_with_a_reason(services, begin):
    order(services, CREATURE)
    begin()
    retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.count == 1
    begin()
    retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.count == 0
    with pytest.raises(RenderingFailed, match="ended the renderer twice"):
        order(services, CREATURE)


def test_a_long_rendering_counts_as_alive_for_all_its_time(services, begin):
    order(services, CREATURE)
    job = begin()
    (execution,) = job.execution_registry.get_execution_ids()
    ends = services.redis.zscore(job.started_job_registry.key, f"{job.id}:{execution}")
    assert ends - time.time() > job.timeout
