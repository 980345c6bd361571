"""Physical units of creatures, archives and captions, against closed forms."""

import json

import numpy as np
import pytest

import microcosmos as mc
from microcosmos import units
from microcosmos.quantities.real import FLUIDS, Real, length_of, like, shown
from microcosmos.quantities.scales import Physical, own_stroke, scaled_by

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32, "viscosity": 0.1},
    "body": {"nodes": 11},
    "control": {"period": 20, "max_speed": None},
    "task": {"steps": 40},
    "archive": {"descriptors": [{"name": "symmetry", "bins": 4}, {"name": "curvature_mean"}]},
    "search": {"generations": 1, "batch": 8, "block": 8, "feasible": False},
}
FOUND = Physical(length=1e-3, cells=10.0, period=0.5, steps=20.0, viscosity=0.1)
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
def test_the_reynolds_number_is_the_same_in_metres_and_seconds():
    """A sperm cell: 50 µm, 100 µm/s in water is Re 0.005."""
    speed = FOUND.node_speed(0.3)
    assert units.reynolds(speed, FOUND.length, FOUND.fluid) == pytest.approx(0.3, rel=1e-12)
    assert units.reynolds(100e-6, 50e-6, FLUIDS["water"]) == pytest.approx(5e-3)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("text", "expected"), [("1mm", 1e-3), ("50 um", 5e-5), ("50µm", 5e-5), ("1.5e-2 m", 0.015)]
)
def test_lengths_are_read(text, expected):
    assert length_of(text) == pytest.approx(expected, rel=1e-12)


@pytest.mark.fast
@pytest.mark.parametrize(
    "text",
    ["1", "mm", "-1mm", "0mm", "1s", "1..2mm", "1 parsec", "1e999m", "1e200m", "1e-200m"],
)
def test_other_lengths_are_refused(text):
    with pytest.raises(ValueError, match="`length` must be a number above 0 with a unit"):
        length_of(text)


@pytest.mark.fast
@pytest.mark.parametrize("length", ["1e-12m", "1000km"])
@pytest.mark.parametrize("period", ["1e-12s", "1e6s"])
def test_the_ends_of_lengths_and_periods_have_scales(length, period):
    real = Real.of(length, period)
    found = Physical(real.length, 10.0, real.period, 20.0, 0.1)
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
    assert like(viscosity) == expected


@pytest.mark.fast
@pytest.mark.parametrize(
    ("value", "expected"),
    [(2.7e-4, "270 µm/s"), (0.0, "0 m/s"), (1.0, "1 m/s"), (0.02, "20 mm/s")],
)
def test_quantities_have_a_prefix(value, expected):
    assert shown(value, "m/s") == expected


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
    assert shown(-1.12e-7, unit) == expected


@pytest.mark.fast
def test_a_slowed_clock_takes_the_steps_of_its_own_stroke():
    slowed = mc.parse(SPEC | {"control": {"period": 20}}).scene
    # 0.3 lengths in a stroke, and 10 in 1,000 steps: a stroke takes 30 steps.
    assert own_stroke(slowed, {"stride": 0.3, "speed": 10.0}) == pytest.approx(30, rel=1e-12)
    assert own_stroke(slowed, {"stride": 0.2, "speed": 10.0001}) == 20, "rounding of float32"
    assert own_stroke(slowed, {}) == 20, "it was not measured"
    still = {"stride": 0.0, "speed": 0.0}
    assert np.isnan(own_stroke(slowed, still)), "it did fewer than two strokes"
    assert own_stroke(mc.parse(SPEC).scene, still) == 20, "nothing slows its clock"


def test_an_unknown_or_impossible_stroke_has_no_units(tmp_path):
    slow = tmp_path / "slow.h5"
    mc.evolve(mc.parse(SPEC | {"control": {"period": 20, "max_speed": 1e-3}}), slow)
    best = json.loads(slow.with_suffix(".best.json").read_bytes())
    for speed, stride in ((0.0, 0.0), (1.0, 1e30), (1.0, 1e-30)):
        best["measured"]["fitness"] = speed
        best["measured"]["measures"] |= {"speed": speed, "stride": stride}
        with pytest.raises(ValueError, match=r"`measured.measures.speed` must be .* 20 to 40"):
            mc.physical(best, "1mm", "0.5s")
    table = mc.physical(slow, "1mm", "0.5s")
    assert len(table["mach"])
    assert np.isnan(table["viscosity_m2_per_s"]).all()
    assert np.isnan(table["sperm"]).all()


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


def test_wrong_periods_and_worlds_without_a_fluid_are_refused(run):
    best = json.loads(run.with_suffix(".best.json").read_bytes())
    with pytest.raises(ValueError, match=r"`period` must be a number above 0 with a unit"):
        mc.physical(best, "1mm", "fast")
    dry = mc.parse(SPEC | {"world": {"width": 32, "height": 32, "fluid": False}}).scene
    with pytest.raises(ValueError, match=r"`world.fluid` must be true for physical units"):
        scaled_by(dry, 10.0, Real(1e-3, 0.5))
