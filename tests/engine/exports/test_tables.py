"""Parquet and Arrow files are read back by pyarrow and pandas, bit for bit."""

import io
import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import microcosmos as mc
from microcosmos.archive import file
from microcosmos.archive.poses import streams
from microcosmos.exports import arrow
from microcosmos.exports.run_file import RunFile

TABLES = ("archive", "curves", "lineage", "genomes", "poses")


def read_parquet(data):
    return pq.read_table(io.BytesIO(data))


def read_arrow(data):
    return pa.ipc.open_file(io.BytesIO(data)).read_all()


READERS = {"parquet": read_parquet, "arrow": read_arrow}


def equal(column, values):
    """Every bit is the same; NaN is NaN."""
    found = column.combine_chunks().to_numpy(zero_copy_only=False)
    assert found.dtype == values.dtype
    assert found.tobytes() == np.ascontiguousarray(values).tobytes()


@pytest.mark.parametrize("form", READERS)
def test_every_table_is_read_back_unchanged_with_its_units(ran, form):
    for name in TABLES:
        table = mc.to_arrow(ran, name, "small")
        again = READERS[form](arrow.WRITERS[form](table))
        assert again.schema.equals(table.schema, check_metadata=True)
        for column in table.column_names:
            if pa.types.is_floating(table[column].type):  # NaN equals NaN.
                equal(again[column], table[column].to_numpy())
            else:
                assert again[column].equals(table[column])
        assert again.schema.field("creature" if name != "curves" else "best").metadata
    assert again.column("run").unique().to_pylist() == ["small"]


@pytest.mark.parametrize("form", READERS)
def test_numbers_have_the_bits_of_the_archive_file(ran, form):
    tree, attributes = file.load(ran.read_bytes())
    tables = {
        name: READERS[form](arrow.WRITERS[form](mc.to_arrow(ran, name))) for name in TABLES
    }
    measures = tree["archive"]["measures"]
    for i, name in enumerate(json.loads(attributes["measures"])):
        equal(tables["archive"][name], measures[:, i])
    for name in ("fitness", "cell", "generation", "curiosity"):
        equal(tables["archive"][name], tree["archive"][name])
    for name in ("qd_score", "coverage", "best", "mean"):
        equal(tables["curves"][name], tree["curves"][name])
    for name, genes in tree["archive"]["genomes"].items():
        found = np.stack(tables["genomes"][name].to_numpy())
        assert found.dtype == genes.dtype
        np.testing.assert_array_equal(found, genes.reshape(len(genes), -1))
    for i, one in enumerate(streams(tree, attributes)):
        rows = tables["poses"].slice(i, 1).to_pylist()[0]
        places = np.stack([rows["x"], rows["y"]], -1).astype(np.float32)
        assert places.tobytes() == one.cells.tobytes()
        assert rows["step"] == one.times.tolist()
        assert rows["edges"] == one.edges.tolist()
        assert rows["creature"] == one.creature


def test_bodies_of_different_sizes_keep_their_nodes(made):
    table = mc.to_arrow(made(sizes=(3, 5, 4)), "poses")
    shapes = [np.stack(x).shape for x in table["x"].to_pylist()]
    assert shapes == [(64, 3), (64, 5), (64, 4)]
    assert table["nodes"].to_pylist() == [3, 5, 4]
    assert table["edges"].to_pylist()[0] == [[0, 1], [1, 2]]


def test_the_schema_holds_spec_units_and_axes(made):
    table = mc.to_arrow(made(), run="one")
    runs = json.loads(table.schema.metadata[b"runs"])
    assert runs["one"]["spec"]["task"]["fitness"] == "speed"
    assert runs["one"]["generation"] == 3
    field = table.schema.field("speed")
    assert field.metadata[b"unit"].decode() == "lengths/1,000 steps"
    assert table.schema.field("fitness").metadata[b"unit"] == field.metadata[b"unit"]
    axis = json.loads(table.schema.field("bending_effort").metadata[b"axis"])
    assert axis == {"low": 1e-4, "high": 100.0, "bins": 4, "scale": "log10"}


def test_several_runs_make_one_table_with_their_names(made, ran):
    runs = [RunFile("a", made()), RunFile("b", ran.read_bytes())]
    for name in TABLES:
        table = read_parquet(arrow.parquet(arrow.of_runs(runs, name)))
        counts = table.column("run").value_counts().to_pylist()
        alone = [mc.to_arrow(one.data, name).num_rows for one in runs]
        assert {one["values"]: one["counts"] for one in counts} == dict(
            zip("ab", alone, strict=True)
        )
    lineage = arrow.of_runs(runs, "lineage")
    rows = lineage.to_pandas()
    assert rows[rows["run"] == "b"]["straightness"].isna().all()
    assert b"axis" in lineage.schema.field("straightness").metadata
    # The fitness of one is a speed, that of the other a displacement.
    runs[0] = RunFile("a", made(spec={"task": {"fitness": "displacement", "steps": 400}}))
    for order in (runs, runs[::-1]):
        schema = arrow.of_runs(order, "archive").schema
        assert schema.field("fitness").metadata == {b"title": b"Fitness"}
        assert schema.field("straightness").metadata.keys() == {b"title", b"unit"}


def of_rows(name, *rows):
    loop = {"generation": np.int64(1), "rows": np.frombuffer(json.dumps(rows).encode(), "u1")}
    facts = {"format": file.FORMAT, "version": "0.1.0", "device": "[]", "spec": "{}"}
    return RunFile(name, file.dump({"loop": loop}, facts))


def test_a_column_without_values_takes_the_type_of_other_runs():
    words, none, numbers = (
        of_rows(name, {"x": value}, {"x": None})
        for name, value in (("a", "fast"), ("b", None), ("c", 0.5))
    )
    for order in ((words, none), (none, words)):
        assert sorted(map(str, arrow.of_runs(order, "result")["x"].to_pylist())) == [
            *("None", "None", "None", "fast")
        ]
    assert arrow.of_runs([none, numbers], "result")["x"].type == pa.float64()
    with pytest.raises(ValueError, match="`x` must have one type in all runs; got double, str"):
        arrow.of_runs([words, numbers], "result")


def test_a_table_that_a_run_lacks_is_refused(ran):
    with pytest.raises(ValueError, match="`table` must be one of archive, curves"):
        mc.to_arrow(ran, "result")
