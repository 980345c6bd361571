"""`microcosmos compare` reads files and folders, and prints or writes tables."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from microcosmos.archive.file import FORMAT, dump
from microcosmos.cli import app
from microcosmos.statistics import read_files

SLOW, FAST = [5.0, 3, 4, 1, 2], [2.5, 6, 7, 8, 9]


@pytest.fixture
def compare():
    def run(*given):
        return CliRunner().invoke(app, ["compare", *map(str, given), "--resamples", "99"])

    return run


@pytest.fixture
def folders(group_of, saved):
    for run in group_of(SLOW):
        slow = saved(run, "slow").parent
    for run in group_of(FAST, world__viscosity=0.2):
        fast = saved(run, "fast").parent
    return slow, fast


def test_a_file_gives_the_run_that_was_saved(run, saved):
    made = run(2.0, seed=4, state="at generation 4 of 2,000")
    made.document["search"]["generations"] = 2000
    (found,) = read_files([saved(made)])
    assert (found.seed, found.state) == (4, "at generation 4 of 2,000")
    assert found.identity == made.identity
    np.testing.assert_array_equal(found.curves["best"], made.curves["best"])


def test_folders_are_groups(compare, folders, tmp_path):
    (tmp_path / "slow" / "creature.h5").write_bytes(dump({}, {"format": "other"}))
    slow, fast = folders
    done = compare(f"slow={slow}", f"fast={fast}")
    assert done.exit_code == 0, done.output
    line = next(one for one in done.output.splitlines() if one.startswith("QD score"))
    assert line.split()[2:5] == ["slow", "5", "3"]
    assert (
        "slow, fast; their specs differ, in this order, in world.viscosity (0.05, 0.2). "
        in done.output
    )


def test_files_without_names_are_grouped_by_spec_and_written(compare, folders, tmp_path):
    files = [file for folder in folders for file in sorted(folder.glob("*.h5"))]
    out = tmp_path / "table.json"
    done = compare(*files, "--as", "json", "--out", out, "--measure", "qd_score>=2")
    assert done.output.split() == [str(out)], done.output
    (measure,) = json.loads(out.read_text())["measures"]
    names = [one["group"] for one in measure["groups"]]
    assert names == ["viscosity 0.05", "viscosity 0.2"]
    assert measure["groups"][0]["values"] == [20, 30, 20, None, 40]


def test_aggregates_over_tasks_are_printed(compare, folders):
    slow, fast = folders
    done = compare(f"all={slow},{fast}", "--task", "world.viscosity")
    assert "Over 2 tasks (world.viscosity 0.05, world.viscosity 0.2)" in done.output


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["a=nowhere.h5"], "a run is a file, a folder or an id on a server, got 'nowhere.h5'"),
        (["a={slow}", "a={fast}"], "groups need names that differ, got 'a' twice"),
        (["a="], "a group is written as NAME=RUN,RUN,..., got 'a='"),
        (["a={slow}", "--as", "word"], "--as must be one of table, csv, json, latex; got word"),
        (
            ["a={slow}", "--measure", "beauty"],
            "a curve must be one of best, corrected_qd_score",
        ),
        (["a={slow}", "b={slow}"], "a run belongs to one group"),
        (["a={empty}"], "the folder needs archive files of searches"),
    ],
)
def test_wrong_use_is_refused_with_a_sentence(compare, folders, tmp_path, given, message):
    (tmp_path / "empty").mkdir()
    slow, fast = folders
    places = {"slow": slow, "fast": fast, "empty": tmp_path / "empty"}
    done = compare(*(one.format(**places) for one in given))
    assert done.exit_code == 2
    assert message in done.output


def test_a_run_without_an_archive_is_refused(compare, tmp_path):
    spec = json.dumps({"experiment": "gaits"})
    path = tmp_path / "gaits.h5"
    path.write_bytes(dump({"loop": {}}, {"format": FORMAT, "spec": spec}))
    assert "a search is needed, whose file has curves; got gaits" in compare(path).output
