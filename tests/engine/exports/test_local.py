"""The command `export` and the function: files, refusals, names."""

from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

import microcosmos as mc
from microcosmos.archive import atomic, export, file
from microcosmos.exports import formats


def test_the_command_prints_each_file_and_its_size(ran, invoke):
    text = invoke("export", str(ran), "--as", "parquet")
    assert "small-parquet/archive.parquet" in text
    assert "kB" in text


def test_nothing_is_overwritten(ran, invoke, tmp_path):
    invoke("export", str(ran), "--as", "alife", "--to", "out")
    before = (tmp_path / "out/phylogeny.csv").read_bytes()
    text = invoke("export", str(ran), "--as", "netcdf", "--to", "out", code=2)
    assert "--to needs a new or empty folder" in text
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["phylogeny.csv"]
    assert (tmp_path / "out/phylogeny.csv").read_bytes() == before


def test_files_go_into_an_empty_folder_a_link_to_one_or_that_of_the_shell(
    ran, invoke, tmp_path, monkeypatch
):
    folder = tmp_path / "empty"
    folder.mkdir()
    (tmp_path / "link").symlink_to(folder)
    assert "link/phylogeny.nwk" in invoke(
        "export", str(ran), "--as", "newick", "--to", str(tmp_path / "link")
    )
    assert [path.name for path in folder.iterdir()] == ["phylogeny.nwk"]
    (folder / "phylogeny.nwk").unlink()
    monkeypatch.chdir(folder)
    mc.export([ran], "newick", ".")
    assert [path.name for path in folder.iterdir()] == ["phylogeny.nwk"]
    assert [path.name for path in Path.cwd().iterdir()] == ["phylogeny.nwk"]
    for to in (".", ".."):
        with pytest.raises(ValueError, match="`to` must name the ZIP file"):
            mc.export([ran], "newick", to, zip=True)


@pytest.mark.parametrize("failure", [OSError("full"), KeyboardInterrupt()])
@pytest.mark.parametrize("exists", [True, False])
def test_a_failure_leaves_nothing_behind(tmp_path, monkeypatch, failure, exists):
    folder, synced = tmp_path / "out", []

    def sync(number):
        synced.append(number)
        if len(synced) == 3:  # Each file syncs itself, and then its folder.
            raise failure

    if exists:
        folder.mkdir()
    before = [*tmp_path.rglob("*")]
    with monkeypatch.context() as patch:
        patch.setattr(atomic.os, "fsync", sync)
        with pytest.raises(type(failure)):
            formats.write({"a.csv": b"a", "b.csv": b"b"}, folder)
        assert len(synced) == 3
    assert [*tmp_path.rglob("*")] == before
    formats.write({"a.csv": b"a"}, folder)
    assert (folder / "a.csv").read_bytes() == b"a"


@pytest.mark.parametrize("exists", [True, False])
def test_an_export_removes_what_a_killed_one_left(tmp_path, monkeypatch, exists):
    folder = tmp_path / "out"
    if exists:
        folder.mkdir()
    with monkeypatch.context() as patch:
        patch.setattr(atomic.os, "fsync", Mock(side_effect=[None, None, KeyboardInterrupt]))
        patch.setattr(atomic.shutil, "rmtree", Mock())  # A killed process removes nothing.
        with pytest.raises(KeyboardInterrupt):
            formats.write({"old.csv": b"old", "b.csv": b"b"}, folder)
    assert [path.name for path in tmp_path.rglob("*.csv")] == ["old.csv"]
    formats.write({"a.csv": b"a"}, folder)
    assert set(tmp_path.rglob("*")) == {folder, folder / "a.csv"}


def test_an_export_removes_no_part_of_a_living_one(tmp_path):
    folder = tmp_path / "out"
    with atomic.folder_part(folder) as part:
        (part / "b.csv").write_bytes(b"b")
        formats.write({"a.csv": b"a"}, folder)
        assert (part / "b.csv").exists()


def test_the_second_of_two_exports_into_one_folder_is_refused(tmp_path):
    class Slow(dict):
        def items(self):
            formats.write({"a.csv": b"first"}, folder)
            return super().items()

    folder = tmp_path / "out"
    with pytest.raises(FileExistsError, match="--to needs a new or empty folder"):
        formats.write(Slow({"a.csv": b"second"}), folder)
    assert list(tmp_path.iterdir()) == [folder]
    assert (folder / "a.csv").read_bytes() == b"first"


def test_a_name_of_a_run_leads_to_no_other_folder(ran, tmp_path):
    other = tmp_path / "...h5"
    other.write_bytes(ran.read_bytes())
    with pytest.raises(ValueError, match=r"`name` of a run must name a folder; got '\.\.'"):
        mc.export([ran, other], "newick", tmp_path / "trees")
    assert list(tmp_path.iterdir()) == [other]


def test_the_command_takes_the_licence_of_a_shared_file_and_names_a_wrong_author(
    made, invoke, tmp_path
):
    (tmp_path / "eels.h5").write_bytes(export.licensed(made(), "CC-BY-NC-4.0", ["Ada"]))
    given = ("export", "eels.h5", "--as", "ro-crate")
    assert "`authors` must be" in invoke(*given, "--author", "Doe,", code=2)
    invoke(*given)
    citation = tmp_path / "eels-ro-crate" / "CITATION.cff"
    assert 'license: "CC-BY-NC-4.0"' in citation.read_text()


def test_an_export_needs_a_run(tmp_path):
    with pytest.raises(ValueError, match="`runs` must have at least one run; got none"):
        mc.export([], "parquet", tmp_path / "none")


def test_several_runs_have_a_folder_each_unless_they_share_a_table(ran, tmp_path):
    other = tmp_path / "other.h5"
    other.write_bytes(ran.read_bytes())
    paths = mc.export([ran, other], "newick", tmp_path / "trees")
    names = [path.relative_to(tmp_path).as_posix() for path in paths]
    assert names == ["trees/small/phylogeny.nwk", "trees/other/phylogeny.nwk"]
    with pytest.raises(ValueError, match="different names; got 'small' twice"):
        mc.export([ran, ran], "arrow", tmp_path / "twice")


def test_a_run_without_an_archive_has_a_table(tmp_path):
    spec = mc.parse({"experiment": "scaling", "nodes": [20, 40], "steps": 10})
    attributes = {
        "format": file.FORMAT,
        "version": "0.1.0",
        "device": '["cpu"]',
        "spec": spec.model_dump_json(),
    }
    rows = b'[{"method": "microcosmos", "nodes": 10, "seconds": 0.5, "fluid": null}]'
    loop = {"generation": np.int64(1), "rows": np.frombuffer(rows, np.uint8)}
    path = tmp_path / "times.h5"
    path.write_bytes(file.dump({"loop": loop}, attributes))
    found = mc.to_arrow(path, "result", "times").to_pandas()
    assert found["seconds"].tolist() == [0.5]
    assert found["method"].tolist() == ["microcosmos"]
    for form in ("netcdf", "newick", "ro-crate"):
        with pytest.raises(ValueError, match="times needs an archive for this format"):
            mc.export([path], form, tmp_path / form)
        assert not (tmp_path / form).exists()


@pytest.mark.parametrize(
    ("argument", "words"),
    [("missing.h5", "no file missing.h5 exists"), ("spec.json", "must be HDF5")],
)
def test_other_arguments_are_refused(invoke, tmp_path, argument, words):
    (tmp_path / "spec.json").write_text("{}")
    assert words in invoke("export", argument, "--as", "arrow", code=2)
