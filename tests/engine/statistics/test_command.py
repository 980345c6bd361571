"""`microcosmos compare` reads files and folders, and prints or writes tables."""

import json

import h5py
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
    with h5py.File(tmp_path / "slow" / "table.h5", "w") as file:
        file.attrs["TITLE"] = "a file of another program"
    slow, fast = folders
    done = compare(f"slow={slow}", f"fa\x1b[2Jst={fast}")
    assert done.exit_code == 0, done.output
    shown = r"fa\u001b[2Jst"
    line = next(one for one in done.output.splitlines() if one.startswith("QD score"))
    assert line.split()[2:5] == ["slow", "5", "3"]
    assert (
        f"slow, {shown}; their specs differ, in this order, in world.viscosity (0.05, 0.2). "
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
    twice = [f"all={slow},{fast}", "--task", "world.viscosity", "--as", "json"]
    twice += ["--measure", "best", "--measure", "best@40", "--measure", "best@4_0"]
    assert [one["measure"] for one in json.loads(compare(*twice).output)] == ["best", "best@40"]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["a=nowhere.h5"], "a run is a file, a folder or an id on a server, got 'nowhere.h5'"),
        (["a={slow}", "a={fast}"], "groups need names that differ, got 'a' twice"),
        (["a="], "a group is written as [NAME=]RUN,RUN,..., got 'a='"),
        (["", "a={slow}"], "a group is written as [NAME=]RUN,RUN,..., got ''"),
        ([" , "], "a group is written as [NAME=]RUN,RUN,..., got ' , '"),
        (["a={slow}", "--as", "word"], "--as must be one of table, csv, json, latex; got word"),
        (
            ["a={slow}", "--measure", "beauty"],
            "a curve must be one of best, corrected_qd_score",
        ),
        (["a={slow}", "b={slow}"], "a run belongs to one group"),
        (["a={empty}"], "the folder needs archive files of searches"),
        (["a={empty}.txt"], "empty.txt: an archive file must be HDF5"),
    ],
)
def test_wrong_use_is_refused_with_a_sentence(compare, folders, tmp_path, given, message):
    (tmp_path / "empty").mkdir()
    (tmp_path / "empty.txt").write_text("no archive")
    slow, fast = folders
    places = {"slow": slow, "fast": fast, "empty": tmp_path / "empty"}
    done = compare(*(one.format(**places) for one in given))
    assert done.exit_code == 2
    assert message in done.output


def test_curves_of_a_group_that_mixes_specs_are_refused(folders, tmp_path):
    slow, fast = folders
    given = ["figure", "curves", f"mix={slow},{fast}", str(tmp_path / "curves.svg")]
    done = CliRunner().invoke(app, given)
    assert done.exit_code == 2
    assert "`world.viscosity` 0.05 in" in done.output


@pytest.mark.parametrize("size", [0, 8, 3000])
def test_a_damaged_file_in_a_folder_is_refused_by_its_name(compare, folders, tmp_path, size):
    slow, fast = folders
    whole = next(fast.glob("*.h5"))
    (fast / "damaged.h5").write_bytes(whole.read_bytes()[:size])
    groups = (f"slow={slow}", f"fast={fast}")
    done = compare(*groups)
    assert done.exit_code == 2
    assert f"{fast / 'damaged.h5'}: an archive file must be HDF5, undamaged" in done.output
    drawn = CliRunner().invoke(app, ["figure", "curves", *groups, str(tmp_path / "a.svg")])
    assert (drawn.exit_code, drawn.output) == (2, done.output)


def test_a_run_without_a_generation_is_refused_by_its_name(folders, saved, run, tmp_path):
    empty = saved(run(seed=9, name="empty.h5", generations=0, state="at generation 0 of 4"))
    for given in ([f"a={empty}"], [f"a={folders[0]}", f"b={empty}"]):
        done = CliRunner().invoke(app, ["figure", "curves", *given, str(tmp_path / "a.svg")])
        assert done.exit_code == 2
        assert f"{empty}: a generation is needed, got a run that has none yet" in done.output


def test_a_run_without_an_archive_is_refused(compare, tmp_path):
    spec = json.dumps({"experiment": "gaits"})
    path = tmp_path / "gaits.h5"
    path.write_bytes(dump({"loop": {}}, {"format": FORMAT, "spec": spec}))
    assert "a search is needed, whose file has curves; got gaits" in compare(path).output
