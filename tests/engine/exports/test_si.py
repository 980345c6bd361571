"""Columns in SI units are read back, and follow from dimensional analysis by hand."""

import io
import json

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import xarray as xr
from typer.testing import CliRunner

import microcosmos as mc
from microcosmos.archive import file
from microcosmos.archive.poses import streams
from microcosmos.cli import app
from microcosmos.exports import arrow
from microcosmos.exports.dataset import netcdf

REAL = {"length": "1mm", "period": "0.5s"}
LENGTH, PERIOD = 1e-3, 0.5

POWERS = {
    # (metres, seconds) of one unit of the lattice, with x metres a cell and t seconds a step.
    "displacement": lambda x, t: x,
    "stretching_effort": lambda x, t: x**2,
    "path_length": lambda x, t: x,
    "mean_speed": lambda x, t: x / t,
    "curvature_mean": lambda x, t: 1 / x,
    "curvature_spread": lambda x, t: 1 / x,
    "total_length": lambda x, t: x,
    "speed": lambda x, t: LENGTH / (1000 * t),
    "advance": lambda x, t: LENGTH / (1000 * t),
    "stride": lambda x, t: LENGTH,
    "beats": lambda x, t: 1 / PERIOD,
    "wave_number": lambda x, t: 1 / LENGTH,
    # A mass of the fluid is an area times density and depth: those two are left out.
    "impulse": lambda x, t: x**2 * x / t,
    "power": lambda x, t: x**2 * x**2 / t**3,
    "cost_of_transport": lambda x, t: x**2 * x**2 / t**2 / LENGTH,
    "trial_spread": lambda x, t: LENGTH / (1000 * t),
}
UNITS = {
    "displacement": "m",
    "stretching_effort": "m^2",
    "mean_speed": "m/s",
    "curvature_mean": "1/m",
    "speed": "m/s",
    "stride": "m",
    "beats": "1/s",
    "wave_number": "1/m",
    "impulse": "m^3/s",
    "power": "m^4/s^3",
    "cost_of_transport": "m^3/s^2",
}


def parquet(table):
    return pq.read_table(io.BytesIO(arrow.parquet(table)))


@pytest.fixture(scope="module")
def scales(ran):
    """Metres a cell of each elite, and seconds a step."""
    tree, attributes = file.load(ran.read_bytes())
    cells = np.array([one.length for one in streams(tree, attributes)])
    return LENGTH / cells, PERIOD / json.loads(attributes["spec"])["control"]["period"]


def test_every_measure_with_a_dimension_is_read_back_in_si(ran, scales):
    found, (cell, step) = parquet(mc.to_arrow(ran, **REAL)), scales
    for name, power in POWERS.items():
        expected = found[name].to_numpy().astype(float) * power(cell, step)
        np.testing.assert_allclose(found[f"{name}_si"].to_numpy(), expected, rtol=1e-12)
    for name, unit in UNITS.items():
        assert found.schema.field(f"{name}_si").metadata[b"unit"].decode() == unit
    known = {"cell_size_si", "viscosity_si", "node_speed_si", "fitness_si"}
    others = {name for name in found.column_names if name.endswith("_si")}
    assert others == {f"{name}_si" for name in POWERS} | known
    assert json.loads(found.schema.metadata[b"real"]) == {"length_m": 1e-3, "period_s": 0.5}


def test_the_fluid_gives_back_the_reynolds_number_in_metres_and_seconds(ran, scales):
    found, (cell, step) = mc.to_arrow(ran, **REAL), scales
    lattice = json.loads(found.schema.metadata[b"runs"])["run"]["spec"]["world"]["viscosity"]
    fluid = found["viscosity_si"].to_numpy()
    np.testing.assert_allclose(fluid, lattice * cell**2 / step, rtol=1e-12)
    np.testing.assert_allclose(
        found["node_speed_si"].to_numpy() * LENGTH / fluid, found["reynolds"].to_numpy()
    )
    np.testing.assert_allclose(found["cell_size_si"].to_numpy(), cell, rtol=1e-12)


def test_the_command_units_says_the_same(ran):
    found, units = mc.to_arrow(ran, **REAL), mc.physical(ran, "1mm", "0.5s")
    assert found["creature"].to_pylist() == list(units["creature"])
    for ours, theirs in (("speed", "speed_m_per_s"), ("viscosity", "viscosity_m2_per_s")):
        np.testing.assert_allclose(found[f"{ours}_si"].to_numpy(), units[theirs], rtol=1e-6)


def test_poses_curves_and_lineage_have_their_columns(ran, scales):
    cell, step = scales
    poses = parquet(mc.to_arrow(ran, "poses", **REAL))
    for row in (0, len(poses) - 1):
        x, in_metres = (np.array(poses[name][row].as_py()) for name in ("x", "x_si"))
        np.testing.assert_allclose(in_metres, x * cell[row], rtol=1e-12)
        times = np.array(poses["step"][row].as_py()) * step
        np.testing.assert_allclose(poses["step_si"][row].as_py(), times, rtol=1e-12)
    np.testing.assert_allclose(poses["length_si"].to_numpy(), LENGTH, rtol=1e-6)
    curves, lineage = (mc.to_arrow(ran, name, **REAL) for name in ("curves", "lineage"))
    for table, name in ((curves, "best"), (lineage, "fitness")):
        expected = table[name].to_numpy().astype(float) * LENGTH / (1000 * step)
        np.testing.assert_allclose(table[f"{name}_si"].to_numpy(), expected, rtol=1e-12)
    assert "coverage_si" not in curves.column_names


def test_each_body_of_a_file_has_its_own_cell(made):
    found = mc.to_arrow(made(lengths=(5.0, 10.0, 20.0)), **REAL)
    np.testing.assert_allclose(found["cell_size_si"].to_numpy(), [2e-4, 1e-4, 5e-5])
    ratio = found["displacement_si"].to_numpy() / found["displacement"].to_numpy()
    np.testing.assert_allclose(ratio, [2e-4, 1e-4, 5e-5])


def test_xarray_reads_them_from_netcdf(ran, scales):
    found = xr.load_dataset(io.BytesIO(netcdf(mc.to_xarray(ran, **REAL))), engine="h5netcdf")
    table = mc.to_arrow(ran, **REAL)
    flat = found["speed_si"].values.reshape(-1)[table["cell"].to_numpy()]
    np.testing.assert_array_equal(flat, table["speed_si"].to_numpy())
    assert found["speed_si"].attrs == {"long_name": "Speed", "units": "m/s"}
    assert found["power_si"].attrs["long_name"] == "Power, over density and depth of the fluid"
    assert (found.attrs["real_length_m"], found.attrs["real_period_s"]) == (1e-3, 0.5)
    with h5py.File(io.BytesIO(netcdf(mc.to_xarray(ran)))) as plain:
        assert not [name for name in plain if name.endswith("_si")]


def test_the_command_writes_them(ran, tmp_path):
    out = tmp_path / "study"
    command = ["export", str(ran), "--as", "arrow", "--to", str(out)]
    done = CliRunner().invoke(app, [*command, "--length", "1mm", "--period", "500 ms"])
    assert done.exit_code == 0, done.output
    with pa.ipc.open_file(out / "archive.arrow") as found:
        assert found.read_all().equals(mc.to_arrow(ran, run=ran.stem, **REAL))


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"length": "1mm", "period": "0.5m"}, "`period` must be a number above 0 with a unit"),
        ({"length": "1s", "period": "1s"}, "`length` must be a number above 0 with a unit"),
        ({"length": "1mm"}, "`length` and `period` must be given together, got `length` '1mm'"),
    ],
)
def test_wrong_units_are_refused_by_library_and_command(ran, tmp_path, given, reason):
    for make in (mc.to_arrow, mc.to_xarray):
        with pytest.raises(ValueError, match=reason):
            make(ran, **given)
    with pytest.raises(ValueError, match=reason):
        mc.export([ran], "parquet", tmp_path / "none", **given)
    options = [text for name, value in given.items() for text in (f"--{name}", value)]
    done = CliRunner().invoke(app, ["export", str(ran), "--as", "netcdf", *options])
    assert done.exit_code == 2
    assert not (tmp_path / "none").exists()


def test_formats_and_runs_without_columns_are_refused(ran, tmp_path, made):
    with pytest.raises(ValueError, match="need one of the formats parquet, arrow, netcdf; got"):
        mc.export([ran], "ro-crate", tmp_path / "none", **REAL)
    linear = made(
        spec={"control": {"timer": "linear"}, "task": {"fitness": "displacement", "steps": 100}}
    )
    with pytest.raises(ValueError, match=r"`control.timer` must repeat a stroke, got 'linear'"):
        mc.to_arrow(linear, **REAL)
