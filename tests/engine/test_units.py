"""Physical scales, dimensionless numbers, and when they warn."""

import numpy as np
import pytest

from microcosmos import units


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
