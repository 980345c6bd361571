"""Physical scales, dimensionless numbers, and when they warn."""

import numpy as np
import pytest

from microcosmos import units


@pytest.mark.fast
@pytest.mark.parametrize("wrong", [0, -1, np.inf, np.nan])
@pytest.mark.parametrize("place", range(4))
def test_scales_need_finite_numbers_above_zero(place, wrong):
    given = [1e-3, 31, 0.1, 200.0]
    given[place] = wrong
    with pytest.raises(ValueError, match="must be finite and above 0, got"):
        units.Scales.of(*given)
    if place == 3 and np.isnan(wrong):  # The steps of a stroke may be unknown.
        assert np.isnan(units.Scales.of_stroke(*given).step)
        return
    with pytest.raises(ValueError, match="must be finite and above 0, got"):
        units.Scales.of_stroke(*given)


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
