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
