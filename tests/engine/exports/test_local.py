"""The command `export` and the function: files, refusals, names."""

import numpy as np
import pytest

import microcosmos as mc
from microcosmos.archive import file
from microcosmos.exports.writing import write


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


def test_a_failure_leaves_nothing_behind(tmp_path, monkeypatch):
    def full(path, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("microcosmos.exports.writing.write_whole", full)
    with pytest.raises(OSError, match="No space left"):
        write({"a/b": b"1"}, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("argument", "words"),
    [("missing.h5", "no file missing.h5 exists"), ("spec.json", "must be HDF5")],
)
def test_other_arguments_are_refused(invoke, tmp_path, argument, words):
    (tmp_path / "spec.json").write_text("{}")
    assert words in invoke("export", argument, "--as", "arrow", code=2)
