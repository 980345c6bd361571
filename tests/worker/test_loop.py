"""The loop that takes jobs from a queue."""

import pytest
import redis
from rq.job import Job
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker

from worker import loop, process, renderer


@pytest.fixture
def worker(services):
    """A worker whose jobs run in this process."""
    return SimpleWorker([services.jobs.renderings], "renderer", serializer=JSONSerializer)


@pytest.fixture
def ask(services):
    """Enqueue a call, and what it calls is recorded."""

    def enqueue(name):
        return services.jobs.renderings.enqueue(
            "builtins.len", name, job_id=name, result_ttl=60
        )

    return enqueue


def test_a_job_is_taken_and_carried_out(worker, ask):
    job = ask("abc")
    loop.take_one(worker)
    assert job.is_finished


def test_it_registers_anew_when_redis_was_emptied(services, worker, ask):
    loop.take_one(worker)
    services.redis.flushdb()
    job = ask("abc")
    loop.take_one(worker)
    assert job.is_finished
    assert services.redis.exists(worker.key)


def test_an_error_of_redis_does_not_end_it(worker, monkeypatch):
    monkeypatch.setattr(loop, "PAUSE_SECONDS", 0)
    turns = []

    def turn(worker):
        turns.append(worker)
        monkeypatch.setattr(process, "_stop_requested", len(turns) > 2)
        raise redis.ResponseError("MISCONF Errors writing to the AOF file")

    monkeypatch.setattr(loop, "take_one", turn)
    loop.serve(worker)
    assert len(turns) == 3


def test_a_replay_whose_renderer_died_is_asked_for_again(services, worker):
    services.jobs.render("ab" * 32)
    job_id = services.jobs.renderings.job_ids[0]
    services.jobs.renderings.pop_job_id()
    job = Job.fetch(job_id, connection=services.redis, serializer=JSONSerializer)
    worker.register_birth()
    execution = worker.prepare_execution(job)
    services.redis.delete(execution.key)  # It expires, before what leads there.
    assert services.jobs.renderings.started_job_registry.get_job_ids() == [job_id]
    renderer.retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.job_ids == [job_id]
    assert not services.jobs.renderings.started_job_registry.get_job_ids()
