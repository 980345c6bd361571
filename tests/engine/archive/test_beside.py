"""Files beside another keep its name, also one with dots."""

import json
from pathlib import Path

import pytest
from small_spec import SMALL_RUN

from microcosmos import spec
from microcosmos.archive.beside import beside
from microcosmos.build.local import evolve
from microcosmos.exports import local
from microcosmos.sinks.record import of_file


@pytest.mark.fast
@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("run.h5", "run.best.json"),
        ("nu0.05.h5", "nu0.05.best.json"),
        ("nu0.05", "nu0.05.best.json"),
        ("tiny ö 0.05", "tiny ö 0.05.best.json"),
        ("Eel.JSON", "Eel.best.json"),
        (".h5", ".h5.best.json"),
        ("in.a.folder/run", "in.a.folder/run.best.json"),
    ],
)
def test_only_known_endings_are_replaced(name, expected):
    assert beside(Path(name), ".best.json") == Path(expected)


@pytest.mark.fast
def test_a_record_of_a_run_has_the_whole_name_of_its_file():
    assert of_file(Path("nu0.05"), {}, 0).name == "nu0.05"


def test_runs_whose_names_differ_after_a_dot_keep_their_best_creatures(tmp_path):
    paths = [tmp_path / "nu0.05", tmp_path / "nu0.1"]
    for seed, path in enumerate(paths):
        document = SMALL_RUN | {"seed": seed, "search": {"generations": 1, "batch": 8}}
        evolve(spec.parse(document), path)
        (best,) = local.best_creature(path).values()
        assert json.loads(best.data)["provenance"]["seed"] == seed
    names = {path.name for path in tmp_path.glob("*.best.json")}
    assert names == {"nu0.05.best.json", "nu0.1.best.json"}
    assert [local.of_path(path).name for path in paths] == ["nu0.05", "nu0.1"]
