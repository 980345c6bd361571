"""A RO-Crate is read back by its library; checksums, citation and command are right."""

import hashlib
import io
import json
import subprocess
import zipfile
from dataclasses import replace
from datetime import date
from importlib import resources

import jsonschema
import pandas as pd
import pytest
import xarray as xr
import yaml
from rocrate.rocrate import ROCrate

import microcosmos as mc
from microcosmos.archive import creature, export
from microcosmos.exports.crate import SUMS, citation, command, crate
from microcosmos.exports.formats import best_creature
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
    assert run["instrument"].id == found.dereference("#exported")["instrument"].id
    assert run["instrument"].id == f"pkg:generic/microcosmos@{run['instrument']['version']}"
    assert found.root_dataset["datePublished"] == "2026-05-04"


def test_the_best_creature_is_that_of_the_archive(ran, tmp_path):
    run, path = RunFile("small", ran.read_bytes()), tmp_path / "small.h5"
    best = path.with_suffix(".best.json")
    own = ran.with_suffix(".best.json").read_bytes()
    foreign = json.loads(own)
    foreign["identity"]["world"]["viscosity"] *= 2
    foreign["sha256"] = creature.name(foreign["identity"])
    assert best_creature(path, run) == {}
    for data, found in ((own, [own]), (json.dumps(foreign).encode(), []), (b"{", [])):
        best.write_bytes(data)
        assert [one.data for one in best_creature(path, run).values()] == found


def test_every_property_is_a_term_of_the_contexts(folder):
    """Those of RO-Crate 1.1 are in the library; the others must be declared."""
    document = json.loads((folder / "ro-crate-metadata.json").read_bytes())
    standard, own = document["@context"]
    assert standard == "https://w3id.org/ro/crate/1.1/context"
    terms = resources.files("rocrate").joinpath("data", "ro-crate.jsonld").read_text()
    known = json.loads(terms)["@context"].keys() | own.keys() | {"@id", "@type"}
    assert {name for one in document["@graph"] for name in one} <= known
    assert own == {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}


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


def test_a_title_is_that_of_the_publication_else_of_the_run(made):
    named, nameless = RunFile("a-1", made(), title="Eels"), RunFile("a-1", made())
    made_up = f"Microcosmos: the archive of a-1 ({named.spec['experiment']})"
    for run, given, expected in (
        (named, "Swimmers", "Swimmers"),
        (named, "", "Eels"),
        (nameless, "", made_up),
        (nameless, "Two\nlines\x85and\u2028more", "Two lines and more"),
    ):
        files = crate(run, mc.Publication(given))
        graph = json.loads(files["ro-crate-metadata.json"])["@graph"]
        assert [one["name"] for one in graph if one["@id"] == "./"] == [expected]
        assert yaml.safe_load(files["CITATION.cff"])["title"] == expected
        assert files["README.md"].decode().startswith(f"# {expected}\n\n")


def test_a_citation_is_yaml_whatever_the_texts_are(made):
    text = "".join(map(chr, range(0x20, 0x2100))) + "\ufeff\ufffd\U0001f41f\n\0\x1b"
    found = yaml.safe_load(citation(text, mc.Publication(authors=[f"{text}é"]), [text]))
    assert found["title"] == found["keywords"][0] == text
    family, _, given = text.partition(",")
    assert found["authors"] == [{"family-names": family.strip(), "given-names": f"{given}é"}]


@pytest.mark.parametrize("licence", ["CC-BY-NC-4.0", "Ask us, please"])
def test_a_shared_archive_keeps_its_licence_and_credit(made, licence):
    credit = ["Ada", "Bo\nB"]
    run = RunFile("eels", export.licensed(made(), licence, credit))
    files = crate(run, PUBLICATION)
    identifier = f"https://spdx.org/licenses/{licence}" if " " not in licence else "#licence"
    entities = {
        one["@id"]: one for one in json.loads(files["ro-crate-metadata.json"])["@graph"]
    }
    assert entities["./"]["license"] == {"@id": identifier}
    assert entities["./"]["creditText"] == "Ada, Bo\nB"
    assert entities[identifier]["name"] == licence
    cited = yaml.load(files["CITATION.cff"], yaml.BaseLoader)
    assert cited.get("license") == (None if " " in licence else licence)
    text = files["README.md"].decode()
    assert f"Licence: {licence}. Credit: Ada, Bo B." in text
    assert "attributes `licence` and `credit` of a share, or of initial creatures" in text
    assert run.facts().items() >= {"licence": licence, "credit": credit}.items()
    other = crate(run, replace(PUBLICATION, licence="CC0-1.0"))["README.md"].decode()
    said = f"Licence: CC0-1.0. The archive file is under another one: {licence}."
    assert said in other


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("eels", {"authors": [""]}, "`authors` must be .*; got ''"),
        ("eels", {"authors": ["Doe, Jane", ", X"]}, "`authors` must be .*; got ', X'"),
        ("eels", {"authors": ["Doe,"]}, "`authors` must be .*; got 'Doe,'"),
        ("eels", {"licence": "my licence, 2 pages"}, "`licence` must be .*; got 'my lic"),
        ("a\nb", {}, r"`name` .* no line breaks; got 'a\\nb'"),
    ],
)
def test_what_the_files_cannot_say_is_refused(made, name, given, words):
    with pytest.raises(ValueError, match=words):
        crate(RunFile(name, made()), mc.Publication(**given))


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


@pytest.mark.parametrize("given", ["record", "record.zip"])
def test_a_zip_holds_the_folder(ran, tmp_path, given):
    (path,) = mc.export([ran], "netcdf", tmp_path / given, zip=True)
    assert path == tmp_path / "record.zip"
    with zipfile.ZipFile(path) as whole:
        assert whole.namelist() == ["record/archive.nc"]
        xr.load_dataset(io.BytesIO(whole.read("record/archive.nc")), engine="h5netcdf")
