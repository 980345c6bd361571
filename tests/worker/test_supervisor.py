"""The process that looks after jobs."""

import signal
import subprocess
import sys

import pytest
from rq.serializers import JSONSerializer

from server.attempts.begin import claim
from server.local import process_tree
from worker import supervisor
from worker.device import Device
from worker.pulse import Pulse
from worker.supervisor import Supervisor

ENGINE_FREE = ["worker.supervisor", "worker.pulse", "worker.loop", "worker.job_process"]


@pytest.mark.parametrize("module", ENGINE_FREE)
def test_what_looks_after_jobs_never_loads_jax(module):
    check = f"import sys, {module}; sys.exit('jax' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", check], check=False).returncode == 0


def test_a_worker_can_be_started_from_any_folder(tmp_path):
    command = [sys.executable, "-c", "import worker.supervisor"]
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == 0


@pytest.fixture
def worker(services):
    worker = Supervisor([services.jobs.runs], "worker", serializer=JSONSerializer)
    worker.services, worker.lease, worker.environment = services, 20, {}
    worker.pulse = Pulse(services.sessions, "worker", Device("a device", 1, {}), 20.0)
    worker.register_birth()
    return worker


def test_a_job_that_does_not_stop_in_time_is_killed_and_its_run_unmarked(
    services, run_id, row, worker, monkeypatch
):
    def begin(*_):
        before = signal.signal(signal.SIGTERM, signal.SIG_IGN)  # The job inherits it.
        worker._horse = subprocess.Popen(["sleep", "60"])
        signal.signal(signal.SIGTERM, before)
        worker._horse_pid = worker._horse.pid
        claim(services, run_id, worker.name)
        worker.pass_on()

    monkeypatch.setattr(supervisor, "PATIENCE", 0.0)
    monkeypatch.setattr(supervisor, "LOOK", 0.05)
    monkeypatch.setattr(worker, "fork_work_horse", begin)
    worker.execute_job(services.jobs.find(str(run_id)), services.jobs.runs)
    assert worker._horse.returncode == -signal.SIGKILL
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


def test_a_job_is_stopped_before_its_supervisor_is_killed():
    assert supervisor.PATIENCE + 2 * supervisor.LOOK < process_tree.GRACE
