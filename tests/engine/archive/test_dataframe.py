"""Our archives are read by pandas and pyribs."""

import importlib.util
import io
import json

import numpy as np
import pytest

import microcosmos
from microcosmos.archive import export, file
from microcosmos.archive.axes import Axis, cells

AXES = [
    {"name": "a", "low": 1e-4, "high": 100.0, "bins": 4, "scale": "log10"},
    {"name": "b", "low": 0.0, "high": 1.0, "bins": 3, "scale": "linear"},
]
AROUND = np.random.default_rng(0).random((12, 2)).astype(np.float32)

pytestmark = [
    pytest.mark.skipif(importlib.util.find_spec("ribs") is None, reason="pyribs: make peers"),
    pytest.mark.filterwarnings("ignore"),
]


@pytest.fixture(params=["grid", "cvt"])
def archive(request):
    return written(request.param)


def written(kind, container=None):
    """A file with an elite in cells 1, 6 and 11, the second on the border of its bin."""
    if kind == "grid":
        cells = np.stack([[0, 2, 3], [1, 0, 2]], 1)
        places = (cells + np.array([[0.5, 0.5], [0.0, 0.0], [0.3, 0.9]])) / [4, 3]
    else:
        places = AROUND[[1, 6, 11]].astype(float)
    raw = np.stack([10 ** (-4 + 6 * places[:, 0]), places[:, 1]], 1)
    tree = {
        "cell": np.array([1, 6, 11], np.int32),
        "fitness": np.array([1.5, 2.5, 0.5], np.float32),
        "measures": raw.astype(np.float32),
        "generation": np.array([1, 2, 2], np.int32),
        "creature": np.arange(96, dtype=np.uint8).reshape(3, 32),
        "genomes": {"weight": np.arange(6, dtype=np.float32).reshape(3, 2)},
        "repeats": {
            "count": np.array([4, 1, 0], np.int32),
            "failed": np.array([1, 1, 0], np.int32),
            "hits": np.array([2, 0, 0], np.int32),
            "fitness": np.array([1.0, 0.0, 0.0], np.float32),
            "squares": np.array([0.5, 0.0, 0.0], np.float32),
        },
    }
    if kind == "cvt":
        tree["centroids"] = AROUND
    described = {"descriptors": AXES, "centroids": None, "container": container}
    spec = json.dumps({"archive": described})
    attributes = {"format": file.FORMAT, "spec": spec, "measures": '["a", "b"]'}
    return file.dump({"archive": tree}, attributes)


def test_pyribs_holds_our_elites_in_our_cells(archive):
    filled = microcosmos.to_ribs(archive)
    ours, theirs = microcosmos.to_pandas(archive), filled.data(return_type="pandas")
    assert list(theirs.columns) == list(ours.columns)
    theirs = theirs.sort_values("index").reset_index(drop=True)
    assert theirs["index"].tolist() == [1, 6, 11]
    for name in ("solution_0", "solution_1", "objective", "threshold", "a", "b", "creature"):
        assert theirs[name].tolist() == ours[name].tolist()
    assert filled.stats.num_elites == 3
    assert filled.stats.qd_score == pytest.approx(4.5)


def test_a_plug_ins_measure_is_a_field_of_pyribs(archive):
    tree, attributes = file.load(archive)
    spec = attributes["spec"].replace('"name": "b"', '"name": "mine.b"')
    renamed = {**attributes, "spec": spec, "measures": '["a", "mine.b"]'}
    theirs = microcosmos.to_ribs(file.dump(tree, renamed)).data(return_type="pandas")
    ours = microcosmos.to_ribs(archive).data(return_type="pandas")
    assert theirs["mine__b"].tolist() == ours["b"].tolist()


def test_the_table_of_the_csv_is_what_their_frame_takes(archive):
    import pandas as pd
    from ribs.archives import ArchiveDataFrame

    frame = ArchiveDataFrame(pd.read_csv(io.StringIO(export.csv(archive))))
    assert frame.get_field("measures").shape == (3, 2)
    assert frame.get_field("solution").shape == (3, 2)
    assert frame.get_field("index").tolist() == [1, 6, 11]


def test_the_table_shows_repeated_evaluations(archive):
    frame = microcosmos.to_pandas(archive)
    assert frame["repeats"].tolist() == [4, 1, 0]
    np.testing.assert_allclose(frame["repeats_mean"], [1.0, np.nan, np.nan])
    np.testing.assert_allclose(frame["repeats_std"], [0.5, np.nan, np.nan])
    np.testing.assert_allclose(frame["repeats_hit_rate"], [0.5, 0.0, np.nan])


@pytest.mark.parametrize("kind", ["grid", "cvt"])
def test_an_archive_with_a_container_becomes_a_grid_by_its_measures(kind):
    """Places 1, 6 and 11 are no cells; pyribs finds the cells."""
    data = written(kind, {"kind": "fronts"})
    ours, filled = microcosmos.to_pandas(data), microcosmos.to_ribs(data)
    assert type(filled).__name__ == "GridArchive"
    assert ours["index"].tolist() == [1, 6, 11]
    np.testing.assert_allclose(10 ** ours["measures_0"], ours["a"], rtol=1e-5)
    theirs = filled.data(return_type="pandas").sort_values("creature").reset_index(drop=True)
    values = [ours["a"].to_numpy(), ours["b"].to_numpy()]
    expected = cells([Axis(**axis) for axis in AXES], values)
    np.testing.assert_array_equal(theirs["index"], expected)
    assert theirs["creature"].tolist() == ours["creature"].tolist()
    assert theirs["objective"].tolist() == ours["objective"].tolist()
