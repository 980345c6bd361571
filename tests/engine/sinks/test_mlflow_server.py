"""A tracking server of MLflow has one record of a run whose process was killed and resumed."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import httpx
import mlflow
import numpy as np
import pytest
from small_spec import SMALL_RUN

from microcosmos.archive.file import load

NEEDED = ("alembic", "flask", "flask_cors", "pandas", "sqlalchemy")
"""Packages of a server that `mlflow-skinny` does not bring; other test libraries do."""
MISSING = [name for name in NEEDED if find_spec(name) is None]
SECONDS = 180.0
GENERATIONS = 24

pytestmark = [
    pytest.mark.long,
    pytest.mark.filterwarnings("ignore"),
    pytest.mark.skipif(bool(MISSING), reason=f"a server of MLflow needs {', '.join(MISSING)}"),
]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """The address of a server on loopback with files of its own."""
    folder = tmp_path_factory.mktemp("mlflow")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "mlflow", "server", "--host", "127.0.0.1"]
    command += ["--port", str(port), "--workers", "1"]
    command += ["--backend-store-uri", f"sqlite:///{folder / 'mlflow.db'}"]
    command += ["--artifacts-destination", str(folder / "artifacts")]
    quiet = {"MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false", "MLFLOW_DISABLE_TELEMETRY": "true"}
    with (folder / "log").open("wb") as log:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=os.environ | quiet,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
        address = f"http://127.0.0.1:{port}"
        try:
            wait_until(lambda: answers(address), f"the server; {(folder / 'log')}")
            yield address
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait(30)


def answers(address):
    try:
        return httpx.get(f"{address}/health", timeout=5).status_code == 200
    except httpx.HTTPError:
        return False


def wait_until(done, what):
    until = time.monotonic() + SECONDS
    while not done():
        assert time.monotonic() < until, f"waited {SECONDS:g} s for {what}"
        time.sleep(0.1)


def evolving(folder, address):
    """Start a run as the command does, with a checkpoint after each generation."""
    options = ["--out", str(folder / "run.h5"), "--sink", f"mlflow:{address}"]
    command = [sys.executable, "-m", "microcosmos", "evolve", str(folder / "spec.json")]
    return subprocess.Popen(
        [*command, *options, "--checkpoint-seconds", "0"],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def records(address):
    """The only run of the server so far, and its steps; none before there is one."""
    client = mlflow.MlflowClient(address)
    place = client.get_experiment_by_name("microcosmos")
    runs = client.search_runs([place.experiment_id]) if place else []
    assert len(runs) <= 1
    run = runs[0] if runs else None
    history = client.get_metric_history(run.info.run_id, "qd_score") if run else []
    return client, run, history


def test_a_killed_run_is_resumed_in_its_record_over_http(server, tmp_path):
    # Long evaluations: the record lags behind the run, which must not end before it is killed.
    search = SMALL_RUN["search"] | {"generations": GENERATIONS}
    spec = SMALL_RUN | {"task": {"steps": 2000}, "search": search}
    (tmp_path / "spec.json").write_text(json.dumps(spec))
    first = evolving(tmp_path, server)
    wait_until(lambda: len(records(server)[2]) >= 3 or first.poll() is not None, "three steps")
    assert first.poll() is None, "The run must not have ended yet."
    first.kill()
    first.wait(30)
    assert evolving(tmp_path, server).wait(SECONDS) == 0

    wait_until(lambda: records(server)[1].info.status == "FINISHED", "the end of the record")
    client, run, history = records(server)
    assert run.data.params["world.width"] == "24"
    curve = load((tmp_path / "run.h5").read_bytes())[0]["curves"]["qd_score"]
    assert [one.step for one in history] == list(range(1, GENERATIONS + 1))
    np.testing.assert_array_equal([one.value for one in history], curve)
    named = {one.path for one in client.list_artifacts(run.info.run_id)}
    assert named == {"run.h5", "run.best.json", "pictures"}
    back = tmp_path / "back"
    back.mkdir()
    local = client.download_artifacts(run.info.run_id, "run.h5", str(back))
    assert Path(local).read_bytes() == (tmp_path / "run.h5").read_bytes()
