"""Columns in SI units are read back, and follow from dimensional analysis by hand."""

import io
import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

import microcosmos as mc
from microcosmos.archive import export, file
from microcosmos.archive.poses import streams
from microcosmos.cli import app
from microcosmos.exports import arrow
from microcosmos.exports.si import of_scene
from microcosmos.quantities.real import Real
from microcosmos.spec import Direct, Scene

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
    """Metres a cell of each elite, and seconds a step: its own stroke takes 0.5 s."""
    tree, attributes = file.load(ran.read_bytes())
    cells = np.array([one.length for one in streams(tree, attributes)])
    table, period = export.columns(ran.read_bytes()), nominal(ran)
    stroked = table["speed"] > 0
    speed = np.where(stroked, table["speed"], np.nan).astype(float)
    steps = 1000 * table["stride"].astype(float) / speed
    assert np.nanmax(steps) > 1.001 * period, "a limit of speed slows some clocks"
    return LENGTH / cells, PERIOD / np.where(
        np.isclose(steps, period, rtol=1e-4), period, steps
    )


def nominal(ran):
    """Steps of a stroke of the clock that nothing slows."""
    return json.loads(file.load(ran.read_bytes())[1]["spec"])["control"]["period"]


def test_a_speed_is_the_stride_of_a_body_in_the_period_of_its_stroke(ran):
    found = mc.to_arrow(ran, **REAL).to_pandas()
    moved = found[found.speed > 0]
    assert len(moved)
    np.testing.assert_allclose(moved.speed_si, moved.stride * LENGTH / PERIOD, rtol=2e-4)


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
    number = np.where(np.isfinite(step), found["reynolds"].to_numpy(), np.nan)
    np.testing.assert_allclose(found["node_speed_si"].to_numpy() * LENGTH / fluid, number)
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
        times = np.array(poses["step"][row].as_py()) * step[row]
        np.testing.assert_allclose(poses["step_si"][row].as_py(), times, rtol=1e-12)
    np.testing.assert_allclose(poses["length_si"].to_numpy(), LENGTH, rtol=1e-6)
    # Of creatures that are gone nobody knows how long a stroke took.
    curves, lineage = (mc.to_arrow(ran, name, **REAL) for name in ("curves", "lineage"))
    step = PERIOD / nominal(ran)
    for table, name in ((curves, "best"), (lineage, "fitness")):
        expected = table[name].to_numpy().astype(float) * LENGTH / (1000 * step)
        np.testing.assert_allclose(table[f"{name}_si"].to_numpy(), expected, rtol=1e-12)
    assert "coverage_si" not in curves.column_names


@pytest.mark.parametrize(("trait", "known"), [("rest_angle", True), ("rest_length", False)])
def test_bodies_of_inherited_lengths_share_no_cell(trait, known):
    control = Direct(**{trait: {"low": 0.5, "high": 1.5}})
    assert (of_scene(Scene(control=control), Real.of(**REAL)).cell is not None) == known


def test_each_body_of_a_file_has_its_own_cell(made):
    found = mc.to_arrow(made(lengths=(5.0, 10.0, 20.0)), **REAL)
    np.testing.assert_allclose(found["cell_size_si"].to_numpy(), [2e-4, 1e-4, 5e-5])
    ratio = found["displacement_si"].to_numpy() / found["displacement"].to_numpy()
    np.testing.assert_allclose(ratio, [2e-4, 1e-4, 5e-5])


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"length": "1mm", "period": "0.5m"}, "`period` must be a number above 0 with a unit"),
        ({"length": "1s", "period": "1s"}, "`length` must be a number above 0 with a unit"),
        ({"length": "1mm"}, "`period` must be given too, got `length` '1mm'"),
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
