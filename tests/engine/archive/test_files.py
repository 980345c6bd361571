"""Files are deterministic, whole or not there, and readable by others."""

import csv
import io
import json
import resource
import signal

import numpy as np
import pytest

from microcosmos.archive import export, file
from microcosmos.archive.atomic import write_whole

pytestmark = pytest.mark.fast


def test_the_same_content_gives_the_same_bytes():
    tree = {"b": {"x": np.arange(5), "y": np.zeros((0, 3))}, "a": np.float64(2)}
    attributes = {"format": file.FORMAT, "spec": "{}"}
    data = file.dump(tree, attributes)
    assert data == file.dump(dict(reversed(tree.items())), attributes)
    back, said = file.load(data)
    assert said == attributes
    np.testing.assert_array_equal(back["b"]["x"], tree["b"]["x"])
    assert back["b"]["y"].shape == (0, 3)


def test_something_else_than_an_archive_is_refused():
    with pytest.raises(ValueError, match="HDF5"):
        file.load(b"something else")
    with pytest.raises(ValueError, match="`format`"):
        file.load(file.dump({}, {"format": "recipe"}))


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
    rows = list(
        csv.DictReader(io.StringIO(export.csv(file.dump({"archive": archive}, attributes))))
    )
    assert list(rows[0]) == [
        *("solution_0", "solution_1", "solution_2", "objective", "measures_0", "measures_1"),
        *("threshold", "a", "b", "generation", "creature", "index"),
    ]
    assert [float(r["measures_0"]) for r in rows] == pytest.approx([-2, 2])
    assert [int(r["index"]) for r in rows] == [3, 7]
    assert [float(r["objective"]) for r in rows] == [1.5, 2.5]


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
