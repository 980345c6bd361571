"""The native kernel in walls, a uniform force and a sponge: closed forms and conservation.

Bodies without a force on the fluid leave it alone.
"""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from kernel_scenes import SCENES, chain, run, scene

from microcosmos import filaments, fluid, world

pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
native = world.native


def undisturbed(surroundings, size, steps, viscosity=0.1):
    """Return the fluid after steps from rest in which no body acts on it."""
    box, start, rest = scene(chain(2), size, force_factor=0.0, magic=fluid.fixed_magic)
    box = replace(box, viscosity=jnp.float32(viscosity), surroundings=surroundings)
    still = [jnp.tile(one[:1], (steps, 1)) for one in (rest.angle, rest.length)]
    end, _ = run(native.rollout, (box, start, filaments.Rest(*still)), steps)
    return end.populations


def velocity(f, force=0.0):
    rho, (x, y) = fluid.density(f), fluid.momentum(f)
    return np.asarray((x + 0.5 * force) / rho, float), np.asarray(y / rho, float)


def test_a_channel_has_the_profile_of_poiseuille():
    width, viscosity = 31, 0.1
    push = 8 * viscosity * 0.01 / width**2
    solid = jnp.zeros((4, width + 1), bool).at[:, 0].set(True)
    around = fluid.Surroundings(jnp.asarray([push, 0], jnp.float32), solid)
    f = undisturbed(around, solid.shape, 40_000, viscosity)
    along, across = velocity(f, push)
    y = np.arange(width) + 0.5
    exact = push / (2 * viscosity) * y * (width - y)
    np.testing.assert_allclose(along[:, 1:], np.tile(exact, (4, 1)), atol=1e-3 * exact.max())
    np.testing.assert_allclose(across, 0, atol=1e-6)


def test_a_uniform_force_accelerates_every_cell_alike():
    push = jnp.asarray([2e-5, -1e-5], jnp.float32)
    f = undisturbed(fluid.Surroundings(push), (24, 37), 200)
    x, y = fluid.momentum(f)
    np.testing.assert_allclose(x, 200 * push[0], rtol=1e-4)
    np.testing.assert_allclose(y, 200 * push[1], rtol=1e-4)


@pytest.mark.parametrize("steps", [1, 20, 200])
def test_a_sponge_approaches_its_stream_geometrically(steps):
    size, stream = (24, 37), jnp.asarray([0.05, 0.01], jnp.float32)
    sponge = fluid.Sponge(jnp.full(size, 0.05, jnp.float32), stream)
    f = undisturbed(fluid.Surroundings(sponge=sponge), size, steps)
    reached = 1 - 0.95**steps
    for found, one in zip(fluid.momentum(f), stream, strict=True):
        np.testing.assert_allclose(found, reached * one, rtol=1e-4)
    np.testing.assert_allclose(fluid.density(f), 1, atol=1e-5)


@pytest.mark.parametrize("name", ["walls", "walls for two layers"])
def test_walls_keep_the_mass_and_stay_empty(name):
    box, start, rest = SCENES[name]()
    end, _ = run(native.rollout, (box, start, rest))
    planes = np.asarray(end.populations, float)
    assert abs(planes).max() > 1e-4
    assert abs(planes.sum()) < 1e-5
    assert not planes[:, np.asarray(box.surroundings.solid)].any()
