"""Bodies in a fluid against what Stokes flow says of them."""

import pytest

from microcosmos import coupling, world
from microcosmos.bodies import ring
from validation import bodies, scenes, swimmers

pytestmark = pytest.mark.long

GHOST = world.Form(projection=coupling.unprojected, theta_feedback=0.0)
"""Edge angles that ignore the geometry exert a torque of their own."""


def test_rings_and_rods_turn_with_a_shear_flow(dtype):
    assert not bodies.check_passive(dtype.name).missed


def test_a_ring_in_the_literal_form_does_not_turn(float64):
    angle, shear = bodies.turned(ring(28, 1.0), float64, form=GHOST)
    assert abs(angle) <= 1e-4 * shear


def test_a_worm_swims_as_fast_as_in_stokes_flow():
    assert not swimmers.check_worm(samples=25).missed


def test_reciprocal_motion_leads_nowhere(dtype):
    assert not swimmers.check_scallop(dtype.name).missed


def test_reciprocal_motion_leads_somewhere_in_the_literal_form(float64):
    ours = swimmers.scallop_share(float64)
    literal = swimmers.scallop_share(float64, form=scenes.LITERAL)
    print(f"displacement over path in a cycle: {ours:.4f}, literal {literal:.4f}")
    assert literal >= 5 * ours
