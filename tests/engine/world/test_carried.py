"""Bodies in a driven flow go with its velocity: half a step of the force has acted on it.

In Guo's scheme the velocity of the fluid is its momentum and half of the force on it, over the
density (Guo, Zheng and Shi, Phys. Rev. E 65, 046308, 2002, eq. 4).
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import bodies, fluid, spec, world
from microcosmos.build import build_flow, build_start, build_world
from validation import scenes
from validation.paths import paths, roll

PAIR = bodies.chain(2, 1.0)


@pytest.fixture(params=paths(), ids=lambda path: path.name)
def path(request):
    return request.param


def in_box(box, place, **surroundings):
    """A pair of nodes in a box, and its first state."""
    built = build_world(box, spec.Coupling(), PAIR)
    if surroundings:
        built = replace(built, surroundings=fluid.Surroundings(**surroundings))
    arms = PAIR.positions - PAIR.positions.mean(0)
    return built, build_start(box, built, arms + np.array(place))


def carried(path, built, start, steps):
    end, seen = roll(path, built, start, scenes.held(PAIR, steps, "float32"), lambda seen: seen)
    return scenes.moved(built, start, end).mean(0), seen


@pytest.mark.parametrize("varied", [False, True])
def test_a_body_falls_with_a_fluid_that_a_force_accelerates(path, varied):
    """From rest, s = a t² / 2: without the half step it would be a t (t - 1) / 2."""
    force, steps = np.array([3e-4, -1e-4], np.float32), 20
    field = np.broadcast_to(force[:, None, None], (2, 32, 32))
    push = {"force_field": jnp.asarray(field)} if varied else {"force": jnp.asarray(force)}
    built, start = in_box(spec.World(width=32, height=32), (16.0, 16.0), **push)
    moved, seen = carried(path, built, start, steps)
    np.testing.assert_allclose(moved, force * steps**2 / 2, rtol=1e-3)
    # Speeds are those before each step, the fastest of all cells.
    expected = np.hypot(*force) * (np.arange(steps) + 0.5)
    np.testing.assert_allclose(seen.speed, expected, rtol=1e-3)


def test_forces_add_up(path):
    """A uniform force and one of each cell act as their sum."""
    uniform, field = jnp.asarray([2e-4, 0.0]), jnp.full((2, 32, 32), 1e-4)
    box = spec.World(width=32, height=32)
    both = in_box(box, (16.0, 16.0), force=uniform, force_field=field)
    moved, _ = carried(path, *both, 10)
    np.testing.assert_allclose(moved, [3e-4 * 50, 1e-4 * 50], rtol=1e-3)


def test_a_viscous_channel_carries_a_body_as_a_thin_fluid_does(path):
    """Half a step of force is 1/28 of the speed at ν 2 in a channel 16 cells high."""
    shares = []
    for viscosity, steps in ((0.05, 2000), (2.0, 2000)):
        flow = spec.Flow(kind="poiseuille", speed=0.02)
        box = spec.World(width=48, height=16, viscosity=viscosity, flow=flow)
        built, start = in_box(box, (24.0, 8.0))
        moved, seen = carried(path, built, start, steps)
        y, across = 8.0 - 0.5, 15
        local = 4 * 0.02 * y * (across - y) / across**2
        shares.append(moved[0] / (local * steps))
        exact = build_flow(box)
        assert exact is not None
        largest = np.hypot(*exact.velocity)[~box.solid].max()
        np.testing.assert_allclose(seen.speed[0], largest, rtol=1e-3)
    thin, viscous = shares
    assert viscous == pytest.approx(thin, rel=0.01)
    assert thin == pytest.approx(1.0, abs=0.02)


def test_the_speed_of_vortices_is_told(path):
    """At ν 2 the force of six vortices in 48 cells is as large as their momentum."""
    flow = spec.Flow(kind="vortices", speed=0.02, vortices=6)
    box = spec.World(width=48, height=48, viscosity=2.0, flow=flow)
    built, start = in_box(box, (24.0, 24.0))
    exact = build_flow(box)
    assert exact is not None
    _, seen = carried(path, built, start, 1)
    np.testing.assert_allclose(seen.speed, np.hypot(*exact.velocity).max(), rtol=1e-3)
    found = jax.jit(world.flow)(built, start)
    np.testing.assert_allclose(found, exact.velocity, atol=1e-6)


def test_walls_are_at_rest():
    flow = spec.Flow(kind="poiseuille", speed=0.02)
    box = spec.World(width=16, height=16, viscosity=2.0, flow=flow)
    built, start = in_box(box, (8.0, 8.0))
    found = np.asarray(world.flow(built, start))
    assert np.all(found[:, box.solid] == 0)
    assert np.all(found[0, ~box.solid] > 0)
