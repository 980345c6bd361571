"""Files are deterministic, complete or absent, and readable by other programs."""

import csv
import fcntl
import io
import json
import resource
import signal
import sys
from io import BytesIO

import h5py
import numpy as np
import pytest

from microcosmos.archive import creature, creature_h5, export, file
from microcosmos.archive.atomic import write_whole
from microcosmos.naming import decode
from microcosmos.spec import shape


@pytest.mark.fast
def test_the_same_content_gives_the_same_bytes():
    tree = {"b": {"x": np.arange(5), "y": np.zeros((0, 3))}, "a": np.float64(2)}
    attributes = {"format": file.FORMAT, "spec": "{}"}
    data = file.dump(tree, attributes)
    assert data == file.dump(dict(reversed(tree.items())), attributes)
    back, loaded = file.load(data)
    assert loaded == attributes
    np.testing.assert_array_equal(back["b"]["x"], tree["b"]["x"])
    assert back["b"]["y"].shape == (0, 3)


@pytest.mark.fast
def test_something_else_than_an_archive_is_refused():
    with pytest.raises(ValueError, match="HDF5"):
        file.load(b"something else")
    with pytest.raises(ValueError, match="`format`"):
        file.load(file.dump({}, {"format": "recipe"}))


@pytest.mark.fast
def test_the_table_has_the_columns_of_pyribs():
    axes = [
        {"name": "a", "low": 1e-4, "high": 100, "scale": "log10"},
        {"name": "b", "low": 0, "high": 1, "scale": "linear"},
    ]
    spec = json.dumps({"archive": {"descriptors": axes}})
    archive = {
        "cell": np.array([3, 7], np.int32),
        "fitness": np.array([1.5, 2.5], np.float32),
        "measures": np.array([[0.01, 0.5], [1e5, 0.25]], np.float32),
        "generation": np.array([1, 2], np.int32),
        "creature": np.arange(64, dtype=np.uint8).reshape(2, 32),
        "genomes": {"weight": np.ones((2, 3), np.float32)},
    }
    attributes = {"format": file.FORMAT, "spec": spec, "measures": '["a", "b"]'}
    table = export.csv(file.dump({"archive": archive}, attributes))
    rows = list(csv.DictReader(io.StringIO(table)))
    assert list(rows[0]) == [
        *("solution_0", "solution_1", "solution_2", "objective", "measures_0", "measures_1"),
        *("threshold", "a", "b", "generation", "creature", "index"),
    ]
    assert [float(r["measures_0"]) for r in rows] == pytest.approx([-2, 2])
    assert [int(r["index"]) for r in rows] == [3, 7]
    assert [float(r["objective"]) for r in rows] == [1.5, 2.5]


@pytest.mark.fast
def test_a_write_that_fails_leaves_the_old_file_and_nothing_beside_it(tmp_path):
    path = tmp_path / "archive.h5"
    write_whole(path, b"old")
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            write_whole(path, b"x" * 100_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.fast
def test_a_write_removes_what_a_killed_one_left_and_no_part_of_a_living_one(tmp_path):
    path, other = tmp_path / "a[1].h5", tmp_path / "b.h5"
    killed, of_other = tmp_path / ".a[1].h5.77.part", tmp_path / ".b.h5.77.part"
    download = tmp_path / f".a[1].h5.{'0f' * 32}.part"
    kept = [tmp_path / ".a[1].h5.78.part", tmp_path / ".a[1].h5.79.part", of_other, download]
    for part in (killed, *kept):
        part.write_bytes(b"half")
    with kept[0].open("rb+") as written, kept[1].open("wb"):  # The latter is not locked yet.
        fcntl.flock(written, fcntl.LOCK_EX)
        write_whole(path, b"whole")
    assert set(tmp_path.iterdir()) == {path, *kept}
    assert path.read_bytes() == b"whole"
    write_whole(other, b"whole")
    assert not of_other.exists()


def test_a_creature_file_survives_hdf5_with_the_same_bytes(newcomer):
    credited = {**newcomer, "credit": ["Ada", "Bob"], "licence": "CC0-1.0"}
    assert creature_h5.load(creature_h5.dump(newcomer)) == newcomer
    assert creature_h5.load(creature_h5.dump(credited)) == credited
    shuffled = json.loads(json.dumps(dict(reversed(newcomer.items()))))
    assert creature_h5.dump(creature.parse(shuffled)) == creature_h5.dump(newcomer)


def test_body_genes_and_figures_are_arrays(newcomer):
    genome, body = newcomer["identity"]["genome"], shape(creature.scene_of(newcomer).body)
    with h5py.File(BytesIO(creature_h5.dump(newcomer)), "r") as found:
        assert found.attrs["sha256"].decode() == newcomer["sha256"]
        np.testing.assert_array_equal(found["body/positions"], body.positions)
        weights = found["genome/connections/weight"]
        np.testing.assert_array_equal(weights, decode(genome["connections"]["weight"]))
        names = [name.decode() for name in found["genome/nodes/activation"]]
        assert names == list(genome["nodes"]["activation"])
        measured = newcomer["measured"]
        assert found["measured/fitness"][()] == measured["fitness"]
        for group in ("measures", "descriptors"):
            arrays = {name: item[()] for name, item in found[f"measured/{group}"].items()}
            assert arrays == measured[group]


NAMES = ["", ".", "..", "/", "a", "a/b", "a/b/../c", "./a", "%", "%2F", "a%2Fb", "nul\0"]
NAMES += ["fitness", "measures", "1/2 é", " ", "%2E", "x" * 200]


def test_names_that_could_be_paths_are_names(newcomer):
    measures = {name: float(number) for number, name in enumerate(NAMES)}
    measured = newcomer["measured"]
    measured = measured | {"measures": measured["measures"] | measures}
    named = creature.parse(newcomer | {"measured": measured})
    data = creature_h5.dump(named)
    assert creature_h5.load(data) == named
    assert len({creature_h5.link(name) for name in NAMES}) == len(NAMES)
    with h5py.File(BytesIO(data), "r") as found:
        assert found["measured/fitness"][()] == newcomer["measured"]["fitness"]
        group = found["measured/measures"]
        assert {name: group[creature_h5.link(name)][()] for name in NAMES} == measures


def test_a_creature_has_a_limited_number_of_measures(newcomer):
    many = {**newcomer["measured"]["measures"], **{f"f{i}": 0.0 for i in range(1000)}}
    with pytest.raises(creature.CreatureError, match="at most 1000") as caught:
        creature.parse({**newcomer, "measured": {**newcomer["measured"], "measures": many}})
    assert caught.value.field == "measured.measures"


def test_a_creature_without_measurement_has_no_measured_group(newcomer):
    bare = creature.parse(creature.document(newcomer["identity"], None, None))
    data = creature_h5.dump(bare)
    assert creature_h5.load(data) == bare
    with h5py.File(BytesIO(data), "r") as found:
        assert "measured" not in found


@pytest.mark.parametrize("data", [b"no HDF5", b""])
def test_other_bytes_are_refused(data):
    with pytest.raises(ValueError, match="must be HDF5"):
        creature_h5.load(data)


def test_a_file_that_was_tampered_with_is_refused(newcomer):
    changed = {**newcomer, "sha256": "0" * 64}
    with pytest.raises(creature.CreatureError, match="sha256"):
        creature_h5.load(creature_h5.dump(changed))


LINKS = [h5py.ExternalLink("other.h5", "/"), h5py.SoftLink("/identity")]


@pytest.mark.parametrize("link", LINKS)
def test_links_out_of_the_file_are_refused(newcomer, link):
    stored = BytesIO(creature_h5.dump(newcomer))
    with h5py.File(stored, "r+") as found:
        del found["body/positions"]
        found["body/positions"] = link
    with pytest.raises(ValueError, match="`/body/positions` must lie in the file itself"):
        creature_h5.load(stored.getvalue())


@pytest.mark.fast
def test_a_missing_package_is_named_with_its_command(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match='pip install "pandas"'):
        export.to_pandas(b"")
