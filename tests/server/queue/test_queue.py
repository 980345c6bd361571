"""Messages, of which Redis keeps no more than is good."""

from rq import SimpleWorker
from rq.serializers import JSONSerializer


def test_a_job_whose_worker_died_can_be_asked_for_again(services, run_id):
    job = services.jobs.find(str(run_id))
    services.jobs.runs.pop_job_id()
    worker = SimpleWorker([services.jobs.runs], serializer=JSONSerializer)
    execution = worker.prepare_execution(job)
    services.redis.delete(execution.key)  # It expires, before what leads there.
    services.jobs.evolve(run_id)
    assert services.jobs.runs.job_ids == [str(run_id)]
    assert not services.jobs.runs.started_job_registry.get_job_ids(cleanup=False)


def test_a_job_that_ends_while_it_is_replaced_leaves_the_new_request(
    services, run_id, monkeypatch
):
    jobs = services.jobs
    jobs.evolve(run_id)
    find = jobs.find

    def found_too_late(job_id):
        job = find(job_id)
        jobs.redis.delete(job.key)  # The worker is through with it, and drops it.
        return job

    monkeypatch.setattr(jobs, "find", found_too_late)
    jobs.evolve(run_id)
    assert str(run_id) in jobs.runs_at_hand()
    assert find(str(run_id)) is not None
