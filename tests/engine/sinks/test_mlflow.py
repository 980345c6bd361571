"""MLflow's own client finds one run with each step once."""

from pathlib import Path

import mlflow
import numpy as np
import pytest

from microcosmos.archive.file import load

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture
def address(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MLflow keeps files of a database beside the process.
    return f"sqlite:///{tmp_path / 'mlflow.db'}"


def only_run(address):
    client = mlflow.MlflowClient(address)
    place = client.get_experiment_by_name("microcosmos").experiment_id
    (run,) = client.search_runs([place])
    return client, run


@pytest.mark.long
def test_curves_pictures_and_files_of_a_run(plain, follow, address, tmp_path):
    path = follow(tmp_path, f"mlflow:{address}") / "run.h5"
    assert path.read_bytes() == plain.read_bytes()
    client, run = only_run(address)
    assert run.info.status == "FINISHED"
    assert run.data.params["world.width"] == "24"
    curves = load(path.read_bytes())[0]["curves"]
    for name in ("qd_score", "coverage", "best", "evaluations"):
        found = client.get_metric_history(run.info.run_id, name)
        assert [one.step for one in found] == [1, 2, 3, 4]
        np.testing.assert_array_equal([one.value for one in found], curves[name])
    named = {one.path for one in client.list_artifacts(run.info.run_id)}
    assert named == {"run.h5", "run.best.json", "pictures"}
    local = client.download_artifacts(run.info.run_id, "run.h5", str(tmp_path / "mlruns"))
    assert Path(local).read_bytes() == path.read_bytes()


@pytest.mark.long
def test_a_resumed_run_goes_on_in_its_record_without_double_steps(attempts, address):
    attempts(f"mlflow:{address}")
    client, run = only_run(address)
    assert run.info.status == "FINISHED"
    found = client.get_metric_history(run.info.run_id, "qd_score")
    assert [(one.step, one.value) for one in found] == [
        *((step, step) for step in range(1, 7)),
        *((step, step + 0.5) for step in (7, 8)),
    ]
