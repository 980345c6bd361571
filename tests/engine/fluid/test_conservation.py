"""What a step of the fluid keeps and what it adds."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fluid
from microcosmos.fluid.lattice import DIRECTIONS

SIZE = (24, 16)


def random_populations(dtype, size=SIZE):
    random = np.random.default_rng(0)
    return tuple(jnp.asarray(random.uniform(-0.01, 0.01, size), dtype) for _ in range(9))


def step(f, force, rates):
    return fluid.stream(fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates))


def total_momentum(f):
    return np.array([np.sum(np.asarray(m, float)) for m in fluid.momentum(f)])


def test_a_force_adds_itself_to_the_momentum_in_every_step(float64):
    f, rates = random_populations(float64), fluid.rates(jnp.asarray(0.02))
    force = jnp.asarray(1e-3 * np.random.default_rng(1).normal(size=(2, *SIZE)) + 1e-3)
    after = step(f, force, rates)
    gained = total_momentum(after) - total_momentum(f)
    np.testing.assert_allclose(gained, np.sum(force, (1, 2)), rtol=1e-12)


def test_collision_keeps_momentum_in_every_cell_but_for_the_force(float64):
    f, rates = random_populations(float64), fluid.rates(jnp.asarray(0.02))
    force = jnp.asarray(1e-3 * np.random.default_rng(1).normal(size=(2, *SIZE)))
    after = fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates)
    np.testing.assert_allclose(fluid.density(after), fluid.density(f), atol=1e-15)
    gained = jnp.stack(fluid.momentum(after)) - jnp.stack(fluid.momentum(f))
    np.testing.assert_allclose(gained, force, atol=1e-15)


def test_equilibrium_has_the_density_and_velocity_it_was_made_for(float64):
    random = np.random.default_rng(0)
    rho = jnp.asarray(1 + 0.1 * random.normal(size=SIZE))
    u = jnp.asarray(0.1 * random.normal(size=(2, *SIZE)))
    f = fluid.equilibrium(rho, u)
    np.testing.assert_allclose(fluid.density(f), rho, rtol=1e-14)
    np.testing.assert_allclose(jnp.stack(fluid.momentum(f)), rho[None] * u, atol=1e-14)


def test_a_fluid_at_rest_stays_exactly_at_rest(dtype):
    f = tuple(jnp.zeros(SIZE, dtype) for _ in range(9))
    after = step(f, jnp.zeros((2, *SIZE), dtype), fluid.rates(jnp.asarray(0.05, dtype)))
    assert all(np.all(np.asarray(plane) == 0) for plane in after)


@pytest.mark.parametrize("direction", range(9))
def test_streaming_moves_each_population_along_its_direction(direction, float64):
    planes = [jnp.zeros(SIZE) for _ in range(9)]
    planes[direction] = planes[direction].at[0, 0].set(1.0)
    moved = fluid.stream(tuple(planes))[direction]
    x, y = DIRECTIONS[direction]
    assert moved[x % SIZE[0], y % SIZE[1]] == 1


def test_vorticity_of_a_rigid_rotation_is_twice_its_rate(float64):
    x, y = np.meshgrid(np.arange(16.0), np.arange(16.0), indexing="ij")
    spin = fluid.vorticity(jnp.asarray(0.01 * np.stack([-y, x])))
    np.testing.assert_allclose(spin[1:-1, 1:-1], 0.02, rtol=1e-12)


def test_one_step_can_be_differentiated(float64):
    inputs = (random_populations(float64), jnp.full((2, *SIZE), 1e-3), jnp.asarray(0.1))
    random = np.random.default_rng(2)
    along = jax.tree.map(lambda x: jnp.asarray(0.01 * random.normal(size=x.shape)), inputs)

    def energy(inputs):
        f, force, viscosity = inputs
        return sum(jnp.sum(plane**2) for plane in step(f, force, fluid.rates(viscosity)))

    def moved(h):
        return energy(jax.tree.map(lambda x, d: x + h * d, inputs, along))

    products = jax.tree.map(lambda g, d: jnp.sum(g * d), jax.grad(energy)(inputs), along)
    expected = (moved(1e-4) - moved(-1e-4)) / 2e-4
    np.testing.assert_allclose(sum(jax.tree.leaves(products)), expected, rtol=1e-7)
