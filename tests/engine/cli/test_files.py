"""Files that commands read and write: creatures as JSON and HDF5, names, tables."""

import csv
import json
from importlib import import_module

import pytest

import microcosmos as mc
from microcosmos.archive import creature_h5

run_command = import_module("microcosmos.cli.run")
study_package = import_module("microcosmos.study")

REAL = ("--length", "1mm", "--period", "0.5s")


@pytest.fixture
def both(newcomer, tmp_path):
    """A creature as JSON and as HDF5."""
    (tmp_path / "eel.json").write_text(json.dumps(newcomer))
    (tmp_path / "eel.h5").write_bytes(creature_h5.dump(newcomer))
    return "eel.json", "eel.h5"


@pytest.mark.parametrize(
    "command", ["replay FILE --check", "network FILE", "units FILE --length 1mm --period 0.5s"]
)
def test_a_command_prints_the_same_for_a_creature_as_json_and_as_hdf5(command, both, invoke):
    json_text, hdf5_text = (invoke(*command.replace("FILE", file).split()) for file in both)
    assert json_text == hdf5_text


@pytest.mark.parametrize(
    ("command", "function"),
    [
        ("audit FILE", "audit.physics.audit"),
        ("gradient FILE", "audit.derivatives.report_gradient"),
    ],
)
def test_audits_read_a_creature_as_hdf5(command, function, both, newcomer, invoke, monkeypatch):
    def stop(file, *_, **__):
        raise ValueError("the same creature" if file == newcomer else "another one")

    monkeypatch.setattr(f"microcosmos.{function}", stop)
    for file in both:
        assert "the same creature" in invoke(*command.replace("FILE", file).split(), code=2)


def test_a_creature_as_hdf5_is_refined(both, newcomer, invoke, monkeypatch):
    carried = []
    monkeypatch.setattr(
        run_command, "run_with_progress", lambda spec, path, *_: carried.append((spec, path))
    )
    monkeypatch.setattr(run_command, "_print_comparison", lambda path: None)
    for file in both:
        invoke("refine", file)
    assert [spec.creature["sha256"] for spec, _ in carried] == 2 * [newcomer["sha256"]]
    assert [path.name for _, path in carried] == 2 * ["eel.refined.h5"]


def test_a_creature_as_hdf5_is_drawn(both, invoke, tmp_path):
    for file in both:
        invoke("figure", file, f"{file}.png")
    first, second = (tmp_path / f"{file}.png" for file in both)
    assert first.read_bytes() == second.read_bytes()


def test_units_of_a_file_are_those_of_its_creature(both, newcomer, tmp_path):
    expected = mc.physical(newcomer, "1mm", "0.5s")
    assert [mc.physical(tmp_path / file, "1mm", "0.5s") for file in both] == 2 * [expected]


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
        "control": {"period": 20},
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
    found = import_module("microcosmos.viz.physical").of_archive
    nan = float("nan")

    def without_stiffness(*given):
        scaled, columns = found(*given)
        return scaled, columns | {"sperm": columns["sperm"] * nan}

    monkeypatch.setattr("microcosmos.viz.physical.of_archive", without_stiffness)
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

    monkeypatch.setattr(study_package, "read", lambda path: None)
    monkeypatch.setattr(study_package, "plan", plan)
    (tmp_path / name).touch()
    assert f"into {folder}" in invoke("study", name, code=2)


def test_a_folder_in_place_of_a_file_is_named(both, invoke, tmp_path):
    (tmp_path / "slow").mkdir()
    text = invoke("network", both[0], "--out", "slow", code=2)
    assert "a file is needed, got the folder slow" in text
    assert not list(tmp_path.glob(".*"))
