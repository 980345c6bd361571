"""Archives without elites have tables without rows, in every format."""

import csv
import io

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import xarray as xr
from made_archives import without_elites

import microcosmos as mc

REAL = {"length": "1mm", "period": "0.5s"}
TABLES = ("archive", "lineage", "genomes", "poses")


@pytest.fixture
def empty(made, tmp_path):
    def make(kind="grid"):
        path = tmp_path / f"{kind}.h5"
        path.write_bytes(without_elites(made(kind)))
        return path

    return make


@pytest.mark.parametrize("kind", ["grid", "cvt", "pool"])
def test_parquet_and_arrow_have_all_columns_and_no_rows(made, empty, tmp_path, kind):
    path = empty(kind)
    for given in ({}, REAL):
        name = f"out{len(given)}"
        mc.export([path], "parquet", tmp_path / name, **given)
        mc.export([path], "arrow", tmp_path / f"{name}-arrow", **given)
        for table in TABLES:
            expected = mc.to_arrow(made(kind), table, kind, **given)
            found = pq.read_table(tmp_path / name / f"{table}.parquet")
            mapped = pa.ipc.open_file(tmp_path / f"{name}-arrow" / f"{table}.arrow").read_all()
            for one in (found, mapped):
                assert one.num_rows == 0
                assert one.column_names == expected.column_names
        assert pq.read_table(tmp_path / name / "curves.parquet").num_rows == 3


def test_a_ro_crate_has_a_table_without_rows(empty, tmp_path, invoke):
    to = tmp_path / "record"
    invoke("export", str(empty()), "--as", "ro-crate", "--to", str(to))
    rows = list(csv.reader(io.StringIO((to / "archive.csv").read_text())))
    assert len(rows) == 1
    assert pq.read_table(to / "tables/genomes.parquet").num_rows == 0
    archive = xr.open_dataset(to / "archive.nc", engine="h5netcdf")
    assert int(archive.fitness.notnull().sum()) == 0
    assert "0 elites after" in (to / "README.md").read_text()
