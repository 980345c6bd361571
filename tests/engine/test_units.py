"""Physical scales, dimensionless numbers, and when they warn."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, filaments, units
from microcosmos.build import build_rods


@pytest.mark.fast
def test_reynolds_and_strouhal_numbers_are_the_same_in_both_units():
    length, viscosity, speed, period = 31.0, 0.05, 0.01, 600
    scales = units.Scales.of(1e-3, length, viscosity)
    metres, seconds = scales.metres(length), scales.seconds(period)
    assert metres == pytest.approx(1e-3)
    here = units.reynolds(speed, length, viscosity)
    there = units.reynolds(scales.speed(speed), metres, units.WATER)
    assert here == pytest.approx(there, rel=1e-12)
    assert metres / (seconds * scales.speed(speed)) == pytest.approx(length / (period * speed))


@pytest.mark.fast
@pytest.mark.parametrize("given", [(0, 31, 0.1), (1e-3, -1, 0.1), (1e-3, 31, 0.0)])
def test_scales_of_nothing_are_refused(given):
    with pytest.raises(ValueError, match="above 0, got"):
        units.Scales.of(*given)


@pytest.mark.fast
def test_the_mach_number_is_one_at_the_speed_of_sound():
    assert units.mach(1 / np.sqrt(3)) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("bend", [1.0, 0.5, 0.05])
@pytest.mark.parametrize("joints", [2, 11, 30])
def test_the_relaxation_time_is_the_one_of_the_projection(joints, bend, float64):
    # Over-relaxation of a chain: Young, Trans. Am. Math. Soc. 76, 92 (1954).
    body = bodies.chain(joints + 2, 1.0, bend=bend)
    rods = build_rods(body, float64)
    rest = filaments.Rest(jnp.asarray(body.rest_angle), jnp.asarray(body.rest_length))
    bent = 0.1 * np.sin(np.pi * np.arange(1, joints + 1) / (joints + 1))
    angles = jnp.asarray(np.concatenate([[0], np.cumsum(bent)]))
    expected = units.relaxation(joints, bend, 1)
    settled = int(5 * expected) + 2

    def after(sweeps):
        given = (jnp.asarray(body.positions), angles, rods, rest)
        _, found = filaments.project(*given, iterations=sweeps)
        return float(jnp.max(jnp.abs(jnp.diff(found))))

    ahead = max(2, round(expected))
    decay = after(settled + ahead) / after(settled)
    assert -ahead / np.log(decay) == pytest.approx(expected, rel=2e-3)


@pytest.mark.fast
def test_more_sweeps_relax_as_much_faster_and_a_soft_long_chain_by_diffusion():
    assert units.relaxation(30, 0.5, 10) == pytest.approx(units.relaxation(30, 0.5, 1) / 10)
    # A sweep with small k is a step of C' = k/2 C'': the mode decays by k/2 (π/(J + 1))².
    joints, bend = 1000, 1e-3
    diffusive = 2 / (bend * (np.pi / (joints + 1)) ** 2)
    assert units.relaxation(joints, bend, 1) == pytest.approx(diffusive, rel=2e-3)


@pytest.mark.fast
@pytest.mark.parametrize(("joints", "bend"), [(0, 1.0), (5, 0.0), (5, 1.5)])
def test_a_chain_that_cannot_relax_is_refused(joints, bend):
    with pytest.raises(ValueError, match="`joints` must be at least 1"):
        units.relaxation(joints, bend, 10)


@pytest.mark.fast
def test_the_sperm_number_is_the_fourth_root_of_frequency_times_relaxation():
    assert units.sperm(2 * np.pi, 1.0) == pytest.approx(1)
    assert units.sperm(100, 16 * 3.0) == pytest.approx(2 * units.sperm(100, 3.0))


@pytest.mark.fast
@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, []),
        ({"mach": 0.2}, ["Mach 0.20 is above 0.17"]),
        ({"limited": 0.05}, ["limits acted on 5.0 % of node steps"]),
        ({"spacing": 2.5}, ["nodes are 2.5 cells apart"]),
        ({"mach": 0.3, "spacing": 3.0}, ["Mach", "cells apart"]),
    ],
)
def test_warnings_name_what_left_its_range(change, expected):
    found = units.warnings(**{"mach": 0.1, "limited": 0.0, "spacing": 1.0} | change)
    assert len(found) == len(expected)
    assert all(words in text for words, text in zip(expected, found, strict=True))
