"""The process that looks after jobs."""

import subprocess
import sys

import pytest

ENGINE_FREE = ["worker.supervisor", "worker.pulse", "worker.loop", "worker.job_process"]


@pytest.mark.parametrize("module", ENGINE_FREE)
def test_what_looks_after_jobs_never_loads_jax(module):
    check = f"import sys, {module}; sys.exit('jax' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", check], check=False).returncode == 0


def test_a_worker_can_be_started_from_any_folder(tmp_path):
    command = [sys.executable, "-c", "import worker.supervisor"]
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == 0
