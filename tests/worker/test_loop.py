"""The loop that takes jobs, the supervisor, its heartbeat and the renderer."""

import os
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import pytest
import redis
from rq.job import Job
from rq.serializers import JSONSerializer
from rq.worker import SimpleWorker
from sqlalchemy import select, update
from sqlalchemy.exc import OperationalError

from microcosmos_server.attempts import claim as claiming
from microcosmos_server.attempts.claim import claim
from microcosmos_server.attempts.leases import Progress
from microcosmos_server.core import processes
from microcosmos_server.local import process_tree
from microcosmos_server.renderings.storage import RenderingFailed, enqueue
from microcosmos_server.tables import CANCELLED, Run, Worker
from microcosmos_server.workers import registry
from microcosmos_worker import loop, readiness, supervisor
from microcosmos_worker.device import Device
from microcosmos_worker.heartbeats import HEARTBEATS_AFTER_END, Heartbeats, Usage
from microcosmos_worker.renderer import mark_stopped, retry_interrupted

CREATURE = "ab" * 32


@pytest.fixture
def worker(services):
    """A worker whose jobs run in this process."""
    return SimpleWorker([services.jobs.renderings], "renderer", serializer=JSONSerializer)


def test_jobs_are_carried_out_also_after_redis_was_emptied(services, worker):
    for empty in (lambda: None, services.redis.flushdb):
        empty()
        job = services.jobs.renderings.enqueue("builtins.len", "abc", result_ttl=60)
        loop.take_one(worker)
        assert job.is_finished
    assert services.redis.exists(worker.key)


def test_an_error_of_redis_does_not_end_it(worker, monkeypatch):
    monkeypatch.setattr(loop, "PAUSE_SECONDS", 0)
    turns = []

    def turn(worker):
        turns.append(worker)
        monkeypatch.setattr(processes, "_stop_requested", len(turns) > 2)
        raise redis.ResponseError("MISCONF Errors writing to the AOF file")

    monkeypatch.setattr(loop, "take_one", turn)
    loop.serve(worker)
    assert len(turns) == 3


def test_a_replay_whose_renderer_died_is_asked_for_again(services, worker):
    services.jobs.render(CREATURE)
    job_id = services.jobs.renderings.job_ids[0]
    services.jobs.renderings.pop_job_id()
    job = Job.fetch(job_id, connection=services.redis, serializer=JSONSerializer)
    worker.register_birth()
    execution = worker.prepare_execution(job)
    services.redis.delete(execution.key)  # It expires, before what leads there.
    assert services.jobs.renderings.started_job_registry.get_job_ids() == [job_id]
    retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.job_ids == [job_id]
    assert not services.jobs.renderings.started_job_registry.get_job_ids()


def test_a_job_that_was_lost_while_it_was_taken_is_failed_and_may_be_asked_for_again(
    services, worker, monkeypatch
):
    """Redis has moved it, and the answer, or whoever asked, is gone."""
    monkeypatch.setattr(loop, "CLEAN_SECONDS", 0)
    enqueue(services, CREATURE)
    queue = services.jobs.renderings
    moved = services.redis.lmove(queue.key, queue.intermediate_queue.key)
    assert not queue.count

    def cleaned():
        turns = iter([False, False, True])
        monkeypatch.setattr(loop, "stop_requested", lambda: next(turns))
        loop.serve(worker, may_work=lambda: False)

    monkeypatch.setattr(loop, "PAUSE_SECONDS", 0)
    cleaned()
    enqueue(services, CREATURE)  # Somebody may be about to begin it.
    assert not queue.count
    seen = queue.intermediate_queue.get_first_seen_key(moved.decode())
    services.redis.set(seen, time.time() - 61)
    cleaned()
    with pytest.raises(RenderingFailed):
        enqueue(services, CREATURE)
    assert not services.redis.exists(queue.intermediate_queue.key)
    services.jobs.remove(moved.decode())  # As Redis does after a minute.
    enqueue(services, CREATURE)
    assert queue.count == 1


def take_and_die(services):
    """Take a rendering job, as a renderer that dies during it."""
    queue = services.jobs.renderings
    renderer = SimpleWorker([queue], serializer=JSONSerializer)
    renderer.register_birth()
    job, _ = queue.dequeue_any([queue], None, services.redis, serializer=JSONSerializer)
    renderer.prepare_execution(job)
    renderer.prepare_job_execution(job)
    renderer.register_death()
    return job


def test_a_replay_that_ends_the_renderer_twice_is_given_up_with_a_reason(services):
    enqueue(services, CREATURE)
    take_and_die(services)
    retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.count == 1
    take_and_die(services)
    retry_interrupted(services.jobs, services.jobs.renderings)
    assert services.jobs.renderings.count == 0
    with pytest.raises(RenderingFailed, match="ended the renderer twice"):
        enqueue(services, CREATURE)


def test_a_job_is_not_blamed_for_stops_of_its_renderer(services):
    enqueue(services, CREATURE)
    queue = services.jobs.renderings
    for _ in range(3):
        take_and_die(services)
        mark_stopped(services.jobs, queue)
        retry_interrupted(services.jobs, queue)
        assert queue.count == 1


def test_a_long_rendering_counts_as_alive_for_all_its_time(services):
    enqueue(services, CREATURE)
    job = take_and_die(services)
    (execution,) = job.execution_registry.get_execution_ids()
    ends = services.redis.zscore(job.started_job_registry.key, f"{job.id}:{execution}")
    assert ends - time.time() > job.timeout


def test_the_supervisor_never_loads_jax_and_starts_in_any_folder(tmp_path):
    modules = "supervisor, heartbeats, loop, job_process"
    check = (
        f"import sys; from microcosmos_worker import {modules}; sys.exit('jax' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", check], cwd=tmp_path).returncode == 0


def test_a_job_that_ignores_the_stop_is_killed_at_no_cost(
    services, run_id, row, busy, next_run, monkeypatch
):
    started = []

    def start(_):
        before = signal.signal(signal.SIGTERM, signal.SIG_IGN)  # The job inherits it.
        started.append(subprocess.Popen(["sleep", "60"]))
        signal.signal(signal.SIGTERM, before)
        busy.job = started[0]
        claim(services, run_id, busy.name)
        busy.stop_job()

    monkeypatch.setattr(supervisor, "STOP_SECONDS", 0.0)
    monkeypatch.setattr(supervisor, "STOP_CHECK_SECONDS", 0.05)
    monkeypatch.setattr(busy, "start", start)
    busy.carry_out(next_run())
    assert started[0].returncode == -signal.SIGKILL
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


@pytest.mark.long
def test_a_job_that_dies_before_its_claim_is_counted_with_its_last_words(
    run_id, row, busy, next_run, capfd, monkeypatch
):
    def python(module, *arguments):
        dies = [sys.executable, "-c", "raise MemoryError('no room')"]
        return dies if module.endswith("job_process") else started(module, *arguments)

    started = processes.python
    monkeypatch.setattr(processes, "python", python)
    busy.carry_out(next_run())
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 1)
    assert "its process ended with status 1" in row().error
    assert "no room" in row().error_details
    assert "Traceback" in capfd.readouterr().err, "the worker's log has all of it"


@pytest.mark.long
def test_a_job_that_cannot_use_the_database_blames_no_run(
    run_id, row, busy, next_run, tmp_path, capfd, monkeypatch
):
    """It makes a new connection, and runs the code that is installed now."""
    assert busy.readiness.check()
    for url in ("sqlite:////proc/none", f"sqlite:///{tmp_path / 'without_tables.db'}"):
        busy.environment["MICROCOSMOS_DATABASE_URL"] = url
        busy.carry_out(next_run())
        assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)
        assert (row().worker, row().error) == (None, None)
        assert busy.readiness.problem.kind == "database"
        assert not busy.readiness.check(), "no run is taken for a while"
        assert "is not begun: (sqlite3.OperationalError)" in capfd.readouterr().err
    monkeypatch.setattr(readiness.time, "monotonic", lambda now=time.monotonic: now() + 61)
    assert busy.readiness.check()
    assert busy.readiness.problem is None


@pytest.mark.parametrize("state", ["57014", "55P03", "25P03"])
def test_a_claim_that_takes_too_long_blames_its_run(services, run_id, monkeypatch, state):
    """Else the worker would try it for ever, and nothing else."""

    class Ended(Exception):
        sqlstate = state

    def end(*_):
        raise OperationalError("", {}, Ended())

    monkeypatch.setattr(claiming, "claim", end)
    with (
        pytest.raises(OperationalError),
        claiming.claimed(services, run_id, "worker", lambda: False),
    ):
        pass


@pytest.mark.parametrize(
    ("code", "how"),
    [
        (3, "ended with status 3"),
        (-9, "was killed by SIGKILL, perhaps for lack of memory"),
        (-11, "was killed by SIGSEGV"),
    ],
)
def test_a_death_is_described(code, how):
    assert processes.exit_reason(code) == how


@pytest.mark.parametrize(
    ("before", "now", "computed"),
    [
        (Progress(1, 71, 60), Progress(2, 61, 60), True),
        (Progress(1, 71, 60), Progress(2, 65, 65), True),
        (Progress(1, 71, 60), Progress(2, 60, 60), False),
        (Progress(1, 71, 60), Progress(1, 71, 60), False),
        (Progress(0, 0, 0), None, False),
    ],
)
def test_an_attempt_has_computed_if_it_is_beyond_the_checkpoint(before, now, computed):
    """Generations after the checkpoint are from the attempt before, until the next claim."""
    assert supervisor.has_computed(before, now) == computed


def test_a_job_is_stopped_before_its_supervisor_is_killed():
    assert supervisor.STOP_SECONDS + 2 * supervisor.STOP_CHECK_SECONDS < process_tree.GRACE


@pytest.fixture
def killed(services, heartbeat, run_id):
    """The runs whose job the heartbeats of their worker have killed."""
    runs = []
    claim(services, run_id, "worker")
    heartbeat.watch(run_id, lambda: runs.append(run_id))
    return runs


def test_a_heartbeat_renews_the_lease_and_reports_device_usage_and_run(
    services, heartbeat, run_id, row, killed
):
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(heartbeat_at=None))
    heartbeat.gauge.last = Usage(5, 0.25)
    heartbeat.beat()
    assert row().heartbeat_at is not None
    with services.sessions.read() as session:
        found = registry.live(session, 20)[0]
    assert (found.name, found.device, found.memory_bytes) == ("worker", "some device", 8 << 30)
    assert (found.kind, found.memory_used_bytes, found.load) == ("gpu", 5, 0.25)
    assert (found.status, found.run_id) == ("busy", run_id)
    assert not killed


@pytest.mark.parametrize(
    ("changes", "patience", "said"),
    [
        ({"worker": "another"}, 0, "Another worker has run"),
        (
            {"status": CANCELLED, "worker": None},
            HEARTBEATS_AFTER_END,
            "has ended, and its process",
        ),
    ],
)
def test_a_job_that_loses_or_outlives_its_run_is_killed(
    services, heartbeat, run_id, killed, changes, patience, said, caplog
):
    caplog.set_level("INFO")
    heartbeat.beat()
    with services.sessions.write.begin() as session:
        session.execute(update(Run).values(**changes))
    for _ in range(patience):
        heartbeat.beat()
    assert not killed
    heartbeat.beat()
    assert killed == [run_id]
    assert said in caplog.text


def test_a_job_that_was_killed_for_its_run_is_no_death(busy, run_id, caplog):
    busy.job = processes.start(["sleep", "60"], os.environ, stderr=subprocess.PIPE)
    busy.output = processes.Output(busy.job)
    threading.Timer(0.2, busy.kill_job, [busy.job]).start()
    busy.monitor(run_id)
    assert busy.error is None
    assert "its process" not in caplog.text


def test_a_job_writes_on_where_the_log_of_its_worker_is_full(monkeypatch):
    """Its last line comes after the first that its worker could not write."""

    class Full:
        def write(self, _):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(processes.sys, "stderr", SimpleNamespace(buffer=Full()))
    lines = "import sys\nfor line in 'ab': print(line, file=sys.stderr, flush=True)"
    child = processes.start([sys.executable, "-c", lines], os.environ, stderr=subprocess.PIPE)
    output = processes.Output(child)
    assert child.wait(60) == 0
    assert output.tail() == "a\nb"


def test_a_job_that_has_not_claimed_its_run_yet_is_left_alone(heartbeat, run_id, next_run):
    killed = []
    assert next_run() == run_id
    heartbeat.watch(run_id, lambda: killed.append(run_id))
    for _ in range(HEARTBEATS_AFTER_END + 2):
        heartbeat.beat()
    assert not killed


def test_an_ended_worker_is_not_listed(services, heartbeat):
    heartbeat.start()
    heartbeat.end()
    with services.sessions.read() as session:
        assert not session.scalars(select(Worker)).all()


@pytest.mark.parametrize(
    "error", [OperationalError("", {}, Exception("it is away")), PermissionError("no gauge")]
)
def test_heartbeats_go_on_after_any_error(services, monkeypatch, error):
    device = Device("a processor", 8 << 30, {})
    heartbeats = Heartbeats(services.sessions, "worker", device, lease=0.1)
    beat, again = heartbeats.beat, threading.Event()

    def fail_once():
        monkeypatch.setattr(heartbeats, "beat", lambda: (beat(), again.set()))
        raise error

    monkeypatch.setattr(heartbeats, "beat", fail_once)
    heartbeats.start()
    assert again.wait(10.0)
    heartbeats.end()
