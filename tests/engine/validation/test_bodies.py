"""Shapes, repulsion, gradients and random controllers, at reduced size."""

import pytest

from validation import bodies, gradients, shapes

pytestmark = pytest.mark.long


def test_chains_close_and_branches_find_their_shape():
    assert not shapes.check().missed


def test_a_shape_that_was_never_asked_for_is_noticed(float64):
    far, _ = shapes.circle(32, 10, float64)
    assert far >= 0.1
    angles, lengths = shapes.branched(0.3, 1, float64)
    assert min(angles, lengths) >= 1e-2


def test_two_bodies_push_each_other_away_and_not_the_fluid(dtype):
    assert not bodies.check_repulsion(name=dtype.name).missed


def test_gradients_with_steric_and_energy_agree_with_finite_differences():
    assert not gradients.check(settings=(gradients.FIELDS,)).missed


def test_random_controllers_stay_finite():
    assert not bodies.check_stability((0.001, 0.01, 2.0), seeds=2, steps=1500).missed
