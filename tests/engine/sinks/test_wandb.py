"""The offline files of W&B hold each step of a run once, under one id."""

import json
import shutil

import numpy as np
import pytest
import wandb_files

from microcosmos.archive.file import load

pytestmark = pytest.mark.filterwarnings("ignore")


def read(folder):
    """Return the ids, the rows and the other records of all offline folders, in order."""
    files = sorted(folder.rglob("run-*.wandb"))
    records = [one for file in files for one in wandb_files.records(file)]
    return files, records, [wandb_files.row(one) for one in records if one.HasField("history")]


def test_curves_pictures_and_files_of_a_run(plain, followed):
    path = followed / "run.h5"
    assert path.read_bytes() == plain.read_bytes()
    (file,), records, rows = read(followed)
    curves = load(path.read_bytes())[0]["curves"]
    assert [row["_step"] for row in rows] == [1, 2, 3, 4]
    for name in ("qd_score", "coverage", "best", "evaluations"):
        np.testing.assert_array_equal([row[name] for row in rows], curves[name])
    assert (file.parent / "files" / rows[-1]["archive/path"]).read_bytes()[:4] == b"\x89PNG"
    (run,) = [one.run for one in records if one.HasField("run")]
    assert run.project == "swimmers"
    config = {one.key: json.loads(one.value_json) for one in run.config.update}
    assert config["world"]["width"] == 24
    artifacts = [one.artifact for one in records if one.HasField("artifact")]
    assert {path.split("/")[-1] for one in artifacts for path in wandb_files.names(one)} == {
        "run.h5",
        "run.best.json",
    }


@pytest.mark.long
def test_a_resumed_run_has_one_id_and_no_double_steps(attempts, wandb_folder):
    attempts("wandb:swimmers")
    files, records, rows = read(wandb_folder)
    assert len(files) == 2
    assert {one.run.run_id for one in records if one.HasField("run")} == {"run-1"}
    assert [(row["_step"], row["qd_score"]) for row in rows] == [
        *((step, step) for step in range(1, 7)),
        *((step, step + 0.5) for step in (7, 8)),
    ]


@pytest.mark.long
def test_a_killed_sink_a_deleted_folder_and_another_project_get_the_steps_again(
    attempt, wandb_folder
):
    def steps():
        return [row["_step"] for row in read(max(wandb_folder.glob("wandb/offline-run-*")))[2]]

    attempt("wandb:swimmers", 0, 6, killed=True)
    attempt("wandb:swimmers", 4, 8)  # It cannot know what of 5 and 6 is in the file.
    assert steps() == [5, 6, 7, 8]
    attempt("wandb:others", 0, 8)
    assert steps() == list(range(1, 9))
    shutil.rmtree(wandb_folder / "wandb")
    attempt("wandb:swimmers", 2, 8)
    assert steps() == list(range(3, 9))
