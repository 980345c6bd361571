"""RQ jobs: at most one for each run and rendering, also in a race."""

from rq import Queue, SimpleWorker
from rq.job import Job
from rq.serializers import JSONSerializer

from server.queue.order import requeue


def test_a_job_whose_worker_died_can_be_asked_for_again(services, run_id):
    job = services.jobs.find(str(run_id))
    services.jobs.runs.pop_job_id()
    worker = SimpleWorker([services.jobs.runs], serializer=JSONSerializer)
    execution = worker.prepare_execution(job)
    services.redis.delete(execution.key)  # It expires, before what leads there.
    requeue(services.sessions, services.jobs, run_id)
    assert services.jobs.runs.job_ids == [str(run_id)]
    assert not services.jobs.runs.started_job_registry.get_job_ids(cleanup=False)


def test_a_job_that_ends_while_it_is_replaced_leaves_the_new_request(
    services, run_id, monkeypatch
):
    jobs = services.jobs
    fetch = Job.fetch_many

    def found_too_late(*arguments):
        (job,) = fetch(*arguments)
        jobs.redis.delete(job.key)  # The worker is through with it, and drops it.
        return [job]

    monkeypatch.setattr(Job, "fetch_many", found_too_late)
    requeue(services.sessions, jobs, run_id)
    assert str(run_id) in jobs.runs_with_job()
    assert jobs.find(str(run_id)) is not None


def test_two_processes_that_enqueue_a_run_at_once_leave_one_job(services, run_id, monkeypatch):
    jobs, prepare = services.jobs, Queue.prepare_data

    def prepared_too_late(*arguments, **options):
        monkeypatch.setattr(Queue, "prepare_data", prepare)
        requeue(services.sessions, jobs, run_id)  # Another process is faster.
        return prepare(*arguments, **options)

    monkeypatch.setattr(Queue, "prepare_data", prepared_too_late)
    requeue(services.sessions, jobs, run_id)
    assert jobs.runs.job_ids == [str(run_id)]
