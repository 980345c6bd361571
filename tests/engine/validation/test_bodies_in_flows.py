"""Held and prescribed bodies in flows, at reduced size."""

import pytest

from validation import cylinder, sheet

pytestmark = pytest.mark.long


def test_the_drag_of_an_array_of_cylinders_is_that_of_the_series():
    assert not cylinder.check_array().missed


@pytest.mark.parametrize("reynolds", [20, 40])
def test_the_drag_of_a_cylinder_in_a_stream_is_near_the_published_one(reynolds):
    # Eight cells across and half of the area: cells and images count for more.
    case = cylinder.Case(reynolds, diameter=8, length=30, height=20, times=25.0)
    assert not cylinder.check((case,), share=0.12).missed


def test_the_wake_of_a_cylinder_swings_at_the_published_frequency():
    case = cylinder.Case(100, diameter=8, length=25, height=15, speed=0.1, times=90.0)
    assert not cylinder.check((case,)).missed


def test_a_swimming_sheet_is_as_fast_as_theory_says():
    assert not sheet.check(sheet.SHEETS[:2]).missed
