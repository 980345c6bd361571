"""Files that commands read and write: creatures as JSON and HDF5, names, tables."""

import csv
import json
import os
from importlib import import_module
from types import SimpleNamespace

import pytest

import microcosmos as mc
from microcosmos.archive import creature, creature_h5

creature_commands = import_module("microcosmos.cli.creature")
run_command = import_module("microcosmos.cli.run")
study_package = import_module("microcosmos.study")

REAL = ("--length", "1mm", "--period", "0.5s")


@pytest.fixture
def both(made_run, tmp_path):
    """A creature as JSON and as HDF5."""
    best = json.loads(made_run.with_suffix(".best.json").read_bytes())
    (tmp_path / "eel.json").write_text(json.dumps(best))
    (tmp_path / "eel.h5").write_bytes(creature_h5.dump(creature.parse(best)))
    return "eel.json", "eel.h5"


@pytest.mark.parametrize(
    "command", ["replay FILE --check", "network FILE", "units FILE --length 1mm --period 0.5s"]
)
def test_a_command_prints_the_same_for_a_creature_as_json_and_as_hdf5(command, both, invoke):
    json_text, hdf5_text = (invoke(*command.replace("FILE", file).split()) for file in both)
    assert json_text == hdf5_text


def test_an_archive_is_no_creature(made_run, invoke):
    text = invoke("replay", made_run, code=2)
    assert "a creature is needed, as JSON or HDF5: attributes must be" in text


@pytest.fixture(scope="module")
def made_run(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.h5"
    document = {
        "experiment": "quality-diversity",
        "world": {"width": 32, "height": 32},
        "body": {"nodes": 8},
        "control": {"period": 20, "max_speed": None},
        "task": {"steps": 40, "fitness": "displacement"},
        "search": {"generations": 1, "batch": 2, "block": 2},
    }
    mc.evolve(mc.parse(document), path)
    return path


def test_units_are_json_and_csv_where_they_are_asked_for(made_run, both, invoke, tmp_path):
    rows = json.loads(invoke("units", made_run, *REAL, "--json"))
    table = mc.physical(made_run, "1mm", "0.5s")
    assert [row["creature"] for row in rows] == list(table["creature"])
    assert [row["reynolds"] for row in rows] == table["reynolds"].tolist()
    assert invoke("units", made_run, *REAL, "--json", "--out", "run.json") == "run.json"
    assert json.loads((tmp_path / "run.json").read_text()) == rows

    numbers = json.loads(invoke("units", both[0], *REAL, "--json"))
    assert invoke("units", both[0], *REAL, "--out", "eel.csv") == "eel.csv"
    with (tmp_path / "eel.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert {name: float(value) for name, value in row.items()} == numbers


def test_units_in_json_have_null_for_no_number(made_run, invoke, monkeypatch):
    found = import_module("microcosmos.quantities.files").of_archive
    nan = float("nan")

    def without_stiffness(*given):
        scaled, columns = found(*given)
        return scaled, columns | {"sperm": columns["sperm"] * nan}

    monkeypatch.setattr("microcosmos.quantities.files.of_archive", without_stiffness)
    text = invoke("units", made_run, *REAL, "--json")
    assert {row["sperm"] for row in json.loads(text)} == {None}


def test_names_with_dots_stay_whole(invoke, tmp_path, monkeypatch, made_run):
    carried = []
    monkeypatch.setattr(
        run_command, "run_with_progress", lambda spec, path, *_, **__: carried.append(path.name)
    )
    document = mc.parse({"experiment": "quality-diversity"}).model_dump_json()
    (tmp_path / "tiny ö 0.05").write_text(document)
    (tmp_path / "tiny 0.1.json").write_text(document)
    (tmp_path / "nu0.05.best.json").touch()
    assert "nu0.05.best.json" in invoke("evolve", "tiny 0.1.json", "--out", "nu0.05")
    invoke("evolve", "tiny ö 0.05")
    invoke("evolve", "tiny 0.1.json")
    invoke("evolve", "demo")
    assert carried == ["nu0.05", "tiny ö 0.05.h5", "tiny 0.1.h5", "demo.h5"]
    (tmp_path / "nu0.05").write_bytes(made_run.read_bytes())
    assert "nu0.05.archive.pdf" in invoke("figure", "archive", "nu0.05")


@pytest.mark.parametrize(
    ("name", "folder"), [("viscosity.yaml", "viscosity.study"), ("nu0.05", "nu0.05.study")]
)
def test_a_study_goes_into_the_folder_of_its_name(name, folder, invoke, tmp_path, monkeypatch):
    def plan(study, folder, beside):
        raise ValueError(f"into {folder.name}")

    monkeypatch.setattr(study_package, "decode", lambda data, name: None)
    monkeypatch.setattr(study_package, "plan", plan)
    (tmp_path / name).touch()
    assert f"into {folder}" in invoke("study", name, code=2)


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("replay eel.json --out eel.json", "--out"),
        ("audit eel.json --out ./eel.json", "--out"),
        ("gradient eel.h5 --out link", "--out"),
        ("network eel.json --out eel.json", "--out"),
        ("units run.h5 --length 1mm --period 0.5s --out run.h5", "--out"),
        ("compare a=run.h5 b=. --out run.h5", "--out"),
        ("compare . --out run.h5", "--out"),
        ("reproject run.h5 --out run.h5", "--out"),
        ("reproject run.h5 --figure run.h5", "--figure"),
        ("evolve demo --from eel.best.json --out eel", "--out"),
        ("evolve spec.json --out spec.json", "--out"),
        ("refine eel.best.json --out eel", "--out"),
        ("cluster join tcp://a:1 --module plug.py --slurm plug.py", "--slurm"),
    ],
)
def test_a_file_that_is_read_is_not_overwritten(
    command, option, both, made_run, invoke, tmp_path
):
    (tmp_path / "run.h5").write_bytes(made_run.read_bytes())
    (tmp_path / "eel.best.json").write_bytes((tmp_path / "eel.json").read_bytes())
    (tmp_path / "spec.json").write_text('{"experiment": "quality-diversity"}')
    (tmp_path / "plug.py").touch()
    (tmp_path / "link").symlink_to("eel.h5")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    text = invoke(*command.split(), code=2)
    assert f"{option} must be another file than the one that is read" in text
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_in_place_of_a_file_is_named(both, invoke, tmp_path):
    (tmp_path / "slow").mkdir()
    text = invoke("network", both[0], "--out", "slow", code=2)
    assert "a file is needed, got the folder slow" in text
    assert not list(tmp_path.glob(".*"))


@pytest.mark.parametrize("out", ["new/x.json", "folder"])
@pytest.mark.parametrize("command", ["audit", "gradient", "replay", "network"])
def test_a_report_that_cannot_be_written_is_refused_first(
    command, out, both, invoke, tmp_path, monkeypatch
):
    (tmp_path / "folder").mkdir()
    monkeypatch.setattr(creature_commands, "prepare_engine", lambda _: pytest.fail("too late"))
    text = invoke(command, both[0], "--out", out, code=2)
    assert text.startswith("--out: a file ")
    assert f"got {out}" in text.replace("the folder ", "")


def test_a_report_is_printed_before_its_file_is_written(both, invoke, tmp_path, monkeypatch):
    report = SimpleNamespace(document=lambda: {"slope": float("nan")}, lines=lambda: ["flat"])
    module = import_module("microcosmos.audit.derivatives")
    monkeypatch.setattr(module, "report_gradient", lambda *_, **__: report)
    assert invoke("gradient", both[0], "--out", "x.json") == "flat"
    assert json.loads((tmp_path / "x.json").read_bytes()) == {"slope": None}

    def full(path, data):
        raise OSError("the disk is full")

    monkeypatch.setattr(creature_commands, "write_whole", full)
    text = invoke("gradient", both[0], "--out", "x.json", code=2)
    assert "flat" in text
    assert "--out: the disk is full" in text


def test_a_path_that_is_no_text_is_printed(both, invoke):
    assert invoke("network", both[0], "--out", os.fsdecode(b"\xff.txt")) == r"\udcff.txt"
