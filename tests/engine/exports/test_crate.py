"""A RO-Crate is read back by its library; checksums, citation and command are right."""

import hashlib
import io
import json
import subprocess
import zipfile
from datetime import date

import jsonschema
import pandas as pd
import pytest
import xarray as xr
import yaml
from rocrate.rocrate import ROCrate

import microcosmos as mc
from microcosmos.exports.crate import SUMS, File, crate
from microcosmos.exports.environment import packages
from microcosmos.exports.readme import command
from microcosmos.exports.run_file import RunFile

AUTHORS = ["Doe, Jane", "The Swimmers"]
PUBLICATION = mc.Publication("Swimmers", AUTHORS, day=date(2026, 5, 4))


@pytest.fixture(scope="module")
def folder(ran, tmp_path_factory):
    to = tmp_path_factory.mktemp("crate") / "record"
    mc.export([ran], "ro-crate", to, publication=PUBLICATION)
    return to


def test_the_library_reads_every_file_and_its_description(folder):
    found = ROCrate(folder)
    files = {str(one.id): one for one in found.data_entities}
    present = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert {*files} == present - {"ro-crate-metadata.json", SUMS}
    for name, one in files.items():
        data = (folder / name).read_bytes()
        assert one["sha256"] == hashlib.sha256(data).hexdigest()
        assert one["contentSize"] == str(len(data))
        assert one["encodingFormat"]
        assert one["description"]
    assert found.name == "Swimmers"
    assert found.mainEntity.id == "small.h5"
    assert str(found.license.id) == "https://spdx.org/licenses/CC-BY-4.0"
    people = found.root_dataset["author"]
    assert [one["name"] for one in people] == ["Jane Doe", "The Swimmers"]
    run = found.dereference("#run")
    assert run["object"].id == "spec.json"
    assert run["result"].id == "small.h5"
    assert found.root_dataset["datePublished"] == "2026-05-04"


def test_checksums_are_those_of_all_files(folder):
    lines = (folder / SUMS).read_text().splitlines()
    sums = dict(reversed(line.split("  ")) for line in lines)
    assert {*sums} | {SUMS} == {
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    }
    for name, digest in sums.items():
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest


def test_the_folder_has_the_run_its_tables_and_its_spec(folder, ran):
    assert (folder / "small.h5").read_bytes() == ran.read_bytes()
    spec = mc.parse(json.loads((folder / "spec.json").read_bytes()))
    assert spec.search.generations == 4
    elites = pd.read_parquet(folder / "tables/archive.parquet")
    archive = xr.open_dataset(folder / "archive.nc", engine="h5netcdf")
    assert int(archive.fitness.notnull().sum()) == len(elites)


# Required keys of the Citation File Format 1.2.0, and the forms of those that we write.
CFF = {
    "required": ["cff-version", "message", "title", "authors"],
    "properties": {
        "cff-version": {"const": "1.2.0"},
        "type": {"enum": ["dataset", "software"]},
        "authors": {
            "minItems": 1,
            "items": {
                "anyOf": [{"required": ["name"]}, {"required": ["family-names"]}],
                "additionalProperties": {"type": "string"},
            },
        },
        "date-released": {"pattern": r"^\d{4}-\d\d-\d\d$"},
        "references": {"items": {"required": ["authors", "title", "type"]}},
    },
}


def test_the_citation_names_the_authors(folder):
    found = yaml.load((folder / "CITATION.cff").read_text(), yaml.BaseLoader)
    jsonschema.validate(found, CFF)
    assert found["authors"] == [
        {"given-names": "Jane", "family-names": "Doe"},
        {"name": "The Swimmers"},
    ]
    assert found["title"] == "Swimmers"
    assert found["date-released"] == "2026-05-04"


def test_the_command_repeats_the_run(folder, ran, tmp_path, invoke):
    text = command(RunFile("small", ran.read_bytes()))
    assert text in (folder / "README.md").read_text()
    (tmp_path / "spec.json").write_bytes((folder / "spec.json").read_bytes())
    invoke(*text.split()[1:])
    assert (tmp_path / "repeated.h5").read_bytes() == ran.read_bytes()


@pytest.mark.parametrize("name", ["small", "my run", "Jane's $run", "repeated"])
def test_a_shell_compares_the_run_with_its_repetition(made, tmp_path, name):
    """The repetition is the file of `--out`: a copy, as the same run would be."""
    run = RunFile(name, made())
    text = crate(run, PUBLICATION)["README.md"].decode()
    block = text.split("```sh\n")[1].split("```")[0].splitlines()
    again = block[1].split("--out ")[1].split()[0]
    assert again != f"{name}.h5"
    for file in (f"{name}.h5", again):
        (tmp_path / file).write_bytes(run.data)
    sums = subprocess.run(["sh", "-c", block[2]], cwd=tmp_path, capture_output=True, check=True)
    digest = hashlib.sha256(run.data).hexdigest()
    assert [line.split()[0] for line in sums.stdout.decode().splitlines()] == [digest] * 2


def test_the_environment_lists_what_the_library_needs():
    found = packages()
    assert {"microcosmos", "jax", "numpy", "h5py", "pydantic-core"} <= {*found}
    assert "pytest" not in found


def test_a_zip_holds_the_folder(ran, tmp_path):
    (path,) = mc.export([ran], "netcdf", tmp_path / "record", zip=True)
    assert path == tmp_path / "record.zip"
    with zipfile.ZipFile(path) as whole:
        assert whole.namelist() == ["record/archive.nc"]
        xr.load_dataset(io.BytesIO(whole.read("record/archive.nc")), engine="h5netcdf")


def test_further_files_are_described(made):
    extra = {"best.json": File(b"{}", "the best creature")}
    files = crate(RunFile("one", made()), PUBLICATION, extra)
    assert files["best.json"] == b"{}"
    assert "`best.json` | the best creature" in files["README.md"].decode()
