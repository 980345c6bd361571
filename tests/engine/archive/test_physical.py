"""Physical units of creatures, archives and captions, against closed forms."""

import csv
import json
from io import StringIO

import numpy as np
import pytest
from typer.testing import CliRunner

import microcosmos as mc
from microcosmos import units
from microcosmos.archive import physical, quantities
from microcosmos.cli import app

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32, "viscosity": 0.1},
    "body": {"nodes": 11},
    "control": {"period": 20},
    "task": {"steps": 40},
    "archive": {"descriptors": [{"name": "symmetry", "bins": 4}, {"name": "curvature_mean"}]},
    "search": {"generations": 1, "batch": 8, "block": 8, "feasible": False},
}
FOUND = physical.Physical(length=1e-3, cells=10.0, period=0.5, steps=20.0, viscosity=0.1)
"""A cell is 0.1 mm, a step 25 ms."""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("run") / "run.h5"
    mc.evolve(mc.parse(SPEC), path)
    return path


@pytest.mark.fast
def test_a_length_and_a_period_fix_cell_step_viscosity_and_speed():
    assert FOUND.scales.cell == pytest.approx(1e-4, rel=1e-12)
    assert FOUND.scales.step == pytest.approx(0.025, rel=1e-12)
    assert FOUND.fluid == pytest.approx(0.1 * 1e-8 / 0.025, rel=1e-12)
    # 0.5 lengths in 1,000 steps, which take 25 s: 0.5 mm in 25 s.
    assert FOUND.swimming(0.5) == pytest.approx(0.5e-3 / 25, rel=1e-12)


@pytest.mark.fast
def test_both_ways_to_scale_agree_on_the_fluid():
    """Scaled by its own fluid, a body has the period that gives this fluid."""
    scales = units.Scales.of(FOUND.length, FOUND.cells, FOUND.viscosity, FOUND.fluid)
    assert scales.cell == pytest.approx(FOUND.scales.cell, rel=1e-12)
    assert scales.seconds(FOUND.steps) == pytest.approx(FOUND.period, rel=1e-12)


@pytest.mark.fast
def test_the_reynolds_number_is_the_same_in_metres_and_seconds():
    """A sperm cell: 50 µm, 100 µm/s in water is Re 0.005."""
    speed = FOUND.node_speed(0.3)
    assert units.reynolds(speed, FOUND.length, FOUND.fluid) == pytest.approx(0.3, rel=1e-12)
    assert units.reynolds(100e-6, 50e-6, quantities.FLUIDS["water"]) == pytest.approx(5e-3)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("text", "expected"), [("1mm", 1e-3), ("50 um", 5e-5), ("50µm", 5e-5), ("1.5e-2 m", 0.015)]
)
def test_lengths_are_read(text, expected):
    assert quantities.length_of(text) == pytest.approx(expected, rel=1e-12)


@pytest.mark.fast
@pytest.mark.parametrize(
    "text",
    ["1", "mm", "-1mm", "0mm", "1s", "1..2mm", "1 parsec", "1e999m", "1e200m", "1e-200m"],
)
def test_other_lengths_are_refused(text):
    with pytest.raises(ValueError, match="`length` must be a number above 0 with a unit"):
        quantities.length_of(text)


@pytest.mark.fast
@pytest.mark.parametrize("length", ["1e-12m", "1000km"])
@pytest.mark.parametrize("period", ["1e-12s", "1e6s"])
def test_the_ends_of_lengths_and_periods_have_scales(length, period):
    real = quantities.Real.of(length, period)
    found = physical.Physical(real.length, 10.0, real.period, 20.0, 0.1)
    # ν = 0.1 cells²/step: a tenth of a hundredth of L² in a twentieth of T.
    assert found.fluid == pytest.approx(0.02 * real.length**2 / real.period, rel=1e-12)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("viscosity", "expected"),
    [
        (1.0e-6, "as water"),
        (1.0e-3, "as glycerol"),
        (5e-6, "between ethanol and air"),
        (0.07, "10 times that of honey"),
        (3.9e-8, "less than common liquids: that of acetone is 10 times as high"),
    ],
)
def test_a_viscosity_is_named_by_a_fluid(viscosity, expected):
    assert quantities.like(viscosity) == expected


@pytest.mark.fast
@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.7e-4, "270 µm/s"), (0.0, "0 m/s"), (1.0, "1 m/s"), (0.02, "20 mm/s")],
)
def test_quantities_have_a_prefix(value, expected):
    assert quantities.shown(value, "m/s") == expected


@pytest.mark.fast
@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("m^3/s^2", "-1.12e-07 m^3/s^2"),
        ("1/s", "-1.12e-07 1/s"),
        ("m", "-112 nm"),
        ("s", "-112 ns"),
    ],
)
def test_powers_of_units_have_no_prefix(unit, expected):
    """A prefix counts before the power: 1 nm³ is 1e-27 m³."""
    assert quantities.shown(-1.12e-7, unit) == expected


def test_a_creature_and_its_row_of_the_archive_agree(run):
    best = json.loads(run.with_suffix(".best.json").read_bytes())
    alone, table = mc.physical(best, "1mm", "0.5s"), mc.physical(run, "1mm", "0.5s")
    row = list(table["creature"]).index(best["sha256"])
    measures = best["measured"]["measures"]
    for name in ("viscosity_m2_per_s", "speed_m_per_s", "reynolds", "strouhal", "mach"):
        assert table[name][row] == pytest.approx(alone[name], rel=1e-6)
    assert alone["viscosity_m2_per_s"] == pytest.approx(0.1 * 1e-8 / 0.025, rel=1e-6)
    assert alone["speed_m_per_s"] == pytest.approx(measures["speed"] * 1e-3 / 25, rel=1e-6)
    assert alone["mach"] == measures["mach"]
    # Actuators leave 24/25 of their error in a step, the default lag; the body is matched.
    follows = -1 / np.log(24 / 25)
    assert alone["sperm"] == pytest.approx((2 * np.pi * follows / 20) ** 0.25, rel=1e-9)
    np.testing.assert_allclose(table["sperm"], alone["sperm"])


def test_the_command_prints_a_creature_and_writes_an_archive(run, tmp_path):
    given = ["--length", "1mm", "--period", "0.5s"]
    shown = CliRunner().invoke(app, ["units", str(run.with_suffix(".best.json")), *given])
    assert "a cell is 100 µm, a step 25 ms, the kinematic viscosity 0.04 mm²/s" in shown.output
    assert "sperm number" in shown.output
    out = tmp_path / "units.csv"
    CliRunner().invoke(app, ["units", str(run), *given, "--out", str(out)])
    rows = list(csv.DictReader(StringIO(out.read_text())))
    table = mc.physical(run, "1mm", "0.5s")
    np.testing.assert_array_equal([float(row["reynolds"]) for row in rows], table["reynolds"])


def test_captions_state_units_if_asked_and_need_both_options(run, tmp_path):
    out = tmp_path / "map.png"
    command = ["figure", "archive", str(run), str(out), "--length", "1mm"]
    assert "must be given together" in CliRunner().invoke(app, command).output
    done = CliRunner().invoke(app, [*command, "--period", "0.5s"])
    assert done.exit_code == 0, done.output
    caption = out.with_suffix(".caption.txt").read_text()
    assert "With a body of 1 mm and a stroke of 500 ms, a cell is 100 µm" in caption
    assert "The fastest swim" in caption


def test_wrong_periods_and_worlds_without_a_fluid_are_refused(run):
    best = json.loads(run.with_suffix(".best.json").read_bytes())
    with pytest.raises(ValueError, match=r"`period` must be a number above 0 with a unit"):
        mc.physical(best, "1mm", "fast")
    dry = mc.parse(SPEC | {"world": {"width": 32, "height": 32, "fluid": False}}).scene
    with pytest.raises(ValueError, match=r"`world.fluid` must be true for physical units"):
        physical.scaled_by(dry, 10.0, quantities.Real(1e-3, 0.5))
