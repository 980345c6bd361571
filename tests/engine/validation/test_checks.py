"""The checks of the validation document, at reduced size, in JAX and in the native kernel."""

from functools import partial

import jax
import jax.numpy as jnp
import pytest

from microcosmos import coupling, world
from microcosmos.bodies import ring
from microcosmos.spec import Gaits
from validation import (
    bodies,
    cylinder,
    environments,
    flows,
    gradients,
    scenes,
    shapes,
    sheet,
    sweep,
    swimmers,
)
from validation.paths import JAX, KERNEL, paths

GHOST = world.Form(projection=coupling.unprojected, theta_feedback=0.0)
"""Edge angles that ignore the geometry exert a torque of their own."""

IN_BOTH_PRECISIONS = {
    "two bodies push each other away and not the fluid": bodies.check_repulsion,
    "Taylor-Green vortices decay at the viscous rate and converge": flows.check_taylor_green,
    "mass and momentum are kept for 10,000 steps": partial(flows.check_conservation, (24, 16)),
    "rings and rods turn with a shear flow": bodies.check_passive,
    "reciprocal motion leads nowhere": swimmers.check_scallop,
}

# Eight cells across and half of the area: cells and images count for more.
RE_20, RE_40 = [
    (cylinder.Case(re, diameter=8, length=30, height=20, times=25.0),) for re in (20, 40)
]
WAKE = [cylinder.Case(100, diameter=8, length=25, height=15, speed=0.1, times=90.0)]
SHORT = Gaits(forms=("ours",), viscosities=(0.05, 0.5, 2.0), period=600, block=3)

CHECKS = {
    "chains close": shapes.check_circle,
    "branches find their shape": partial(shapes.check_branches, dtype="float32"),
    "bodies take the shape of their curve": shapes.check_matching,
    "walls stand halfway but for rounding": partial(
        flows.check_poiseuille, (0.6, 2.0), (0.6,), "float32"
    ),
    "random controllers stay finite": partial(
        bodies.check_stability, (0.001, 0.01, 2.0), 2, 1500
    ),
    "the drag of an array of cylinders is that of the series": cylinder.check_array,
    "the drag of an array of posts is that of the series": partial(
        environments.check_posts, (5,)
    ),
    "flows of a world stay": partial(environments.check_flows, 2000),
    "a shear turns a ring and a channel carries a tracer": environments.check_carried,
    "a cylinder at Re 20 has the published drag": partial(cylinder.check, RE_20, 0.12),
    "a cylinder at Re 40 has the published drag": partial(cylinder.check, RE_40, 0.12),
    "the wake of a cylinder swings at the published frequency": partial(cylinder.check, WAKE),
    "a swimming sheet is as fast as theory says": partial(sheet.check, sheet.SHEETS[:2]),
    "a worm swims as fast as in Stokes flow": partial(swimmers.check_worm, samples=25),
    # With so short a stroke the soft ray is still settling into its shape at ν 2.
    "swimmers stand to each other as in the paper": partial(sweep.check, SHORT, rest=0.25),
}


def on(path):
    """The path, unless this machine lacks it."""
    if path not in paths():
        pytest.skip("microcosmos-kernels is not installed, or JAX is chosen")
    return path


@pytest.fixture(params=[JAX, KERNEL], ids=lambda path: path.name)
def path(request):
    return on(request.param)


@pytest.fixture(params=["JAX float32", "JAX float64", "kernel float32"])
def way(request):
    """A path, and a precision that it has."""
    name, precision = request.param.split()
    with jax.enable_x64(precision == "float64"):
        yield {"path": on(JAX if name == JAX.name else KERNEL), "dtype": jnp.dtype(precision)}


def test_shear_waves_decay_at_the_viscous_rate(way):
    assert not flows.check_shear_wave((0.53, 0.8, 2.0), **way).failed


@pytest.mark.long
@pytest.mark.parametrize("claim", IN_BOTH_PRECISIONS)
def test_a_check_passes_in_both_precisions(claim, way):
    assert not IN_BOTH_PRECISIONS[claim](**way).failed


@pytest.mark.long
@pytest.mark.optimised  # They compute for longer than they compile.
@pytest.mark.parametrize("claim", CHECKS)
def test_a_check_passes(claim, path):
    assert not CHECKS[claim](path=path).failed


@pytest.mark.long
def test_kolmogorov_flow_is_exact_to_a_thousandth_at_any_viscosity(dtype):
    assert not flows.check_kolmogorov(dtype).failed


@pytest.mark.long
def test_gradients_agree_with_differences():
    assert not gradients.check(200, (gradients.FIELDS,)).failed


@pytest.mark.long
@pytest.mark.optimised
def test_walls_stand_exactly_halfway():
    assert not flows.check_poiseuille((0.6, 2.0), (0.6,)).failed


@pytest.mark.long
def test_branches_find_their_shape_exactly():
    assert not shapes.check_branches().failed


@pytest.mark.long
def test_a_shape_that_was_never_asked_for_is_noticed(float64):
    far, _ = shapes.circle(32, 10, float64)
    assert far >= 0.1
    angles, lengths = shapes.branched(0.3, 1, float64)
    assert min(angles, lengths) >= 1e-2


@pytest.mark.long
def test_a_ring_in_the_literal_form_does_not_turn(float64):
    angle, shear = bodies.turn_and_shear(ring(28, 1.0), float64, form=GHOST)
    assert abs(angle) <= 1e-4 * shear


@pytest.mark.long
def test_reciprocal_motion_leads_somewhere_in_the_literal_form(float64):
    ours = swimmers.scallop_share(float64)
    assert swimmers.scallop_share(float64, form=scenes.LITERAL) >= 5 * ours
