"""The process that looks after jobs."""

import signal
import subprocess
import sys

import pytest
from rq.serializers import JSONSerializer

from server.attempts.claim import claim
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
    started = []

    def start(_):
        before = signal.signal(signal.SIGTERM, signal.SIG_IGN)  # The job inherits it.
        started.append(subprocess.Popen(["sleep", "60"]))
        signal.signal(signal.SIGTERM, before)
        worker.job = started[0]
        claim(services, run_id, worker.name)
        worker.stop_job()

    monkeypatch.setattr(supervisor, "PATIENCE", 0.0)
    monkeypatch.setattr(supervisor, "STOP_CHECK_SECONDS", 0.05)
    monkeypatch.setattr(worker, "start", start)
    worker.execute_job(services.jobs.find(str(run_id)), services.jobs.runs)
    assert started[0].returncode == -signal.SIGKILL
    assert (row().status, row().attempts_without_checkpoint) == ("queued", 0)


def test_a_job_is_stopped_before_its_supervisor_is_killed():
    assert supervisor.PATIENCE + 2 * supervisor.STOP_CHECK_SECONDS < process_tree.GRACE
