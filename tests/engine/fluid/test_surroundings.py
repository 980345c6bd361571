"""What walls, a uniform force and a sponge do to the fluid in one step and in many."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fluid
from microcosmos.fluid.adjoint import collision
from microcosmos.fluid.lattice import DIRECTIONS

SIZE = (12, 10)
NO_FORCE = np.zeros((2, *SIZE))


def random_populations(seed=0):
    random = np.random.default_rng(seed)
    return tuple(jnp.asarray(random.uniform(-0.01, 0.01, SIZE)) for _ in range(9))


def advance(f, surroundings, force=NO_FORCE, viscosity=0.05):
    rates = fluid.rates(jnp.asarray(viscosity))
    rho, momentum = fluid.density(f), fluid.momentum(f)
    return fluid.advance(f, rho, momentum, jnp.asarray(force), rates, surroundings)


def scattered():
    """Cells of wall strewn over the box, corners and the seam among them."""
    return jnp.asarray(np.random.default_rng(3).random(SIZE) < 0.3)


def without_fluid_in(solid, f):
    return tuple(jnp.where(solid, 0.0, plane) for plane in f)


def mass(f):
    return sum(float(jnp.sum(plane)) for plane in f)


@pytest.mark.fast
def test_empty_surroundings_compile_to_collision_and_streaming_alone(float64):
    f = random_populations()
    rates, force = fluid.rates(jnp.asarray(0.05)), jnp.asarray(NO_FORCE)

    def plain(f):
        rho, momentum = fluid.density(f), fluid.momentum(f)
        return fluid.stream(collision(f, rho, momentum, force, rates))

    def advanced(f):
        rho, momentum = fluid.density(f), fluid.momentum(f)
        return fluid.advance(f, rho, momentum, force, rates, fluid.Surroundings())

    assert str(jax.make_jaxpr(advanced)(f)) == str(jax.make_jaxpr(plain)(f))


@pytest.mark.parametrize("direction", range(1, 9))
def test_what_would_enter_a_wall_comes_back_the_way_it_came(direction, float64):
    solid = jnp.zeros(SIZE, bool).at[5, 5].set(True)
    f, surroundings = random_populations(), fluid.Surroundings(solid=solid)
    f = without_fluid_in(solid, f)
    rates = fluid.rates(jnp.asarray(0.05))
    collided = fluid.collide(
        f, fluid.density(f), fluid.momentum(f), jnp.asarray(NO_FORCE), rates
    )
    x, y = DIRECTIONS[direction]
    back = DIRECTIONS.index((-x, -y))
    neighbour = (5 - x, 5 - y)
    assert advance(f, surroundings)[back][neighbour] == collided[direction][neighbour]


def test_walls_keep_the_mass_and_stay_empty(float64):
    solid = scattered()
    start = without_fluid_in(solid, random_populations())
    f, surroundings = start, fluid.Surroundings(solid=solid)
    for _ in range(50):
        f = advance(f, surroundings)
    assert abs(mass(f) - mass(start)) <= 1e-14
    assert all(np.all(np.asarray(plane)[np.asarray(solid)] == 0) for plane in f)


def test_a_uniform_force_adds_itself_to_every_cell(float64):
    f, push = random_populations(), jnp.asarray([1e-3, -2e-3])
    alone, pushed = (advance(f, s) for s in (fluid.Surroundings(), fluid.Surroundings(push)))
    gained = jnp.stack(fluid.momentum(pushed)) - jnp.stack(fluid.momentum(alone))
    np.testing.assert_allclose(jnp.sum(gained, (1, 2)), push * gained[0].size, rtol=1e-12)


def test_a_sponge_leads_the_fluid_to_its_stream(float64):
    sponge = fluid.Sponge(jnp.full(SIZE, 0.2), jnp.asarray([0.05, 0.01]))
    f = random_populations()
    for _ in range(120):
        f = advance(f, fluid.Surroundings(sponge=sponge))
    u = jnp.stack(fluid.momentum(f)) / fluid.density(f)[None]
    np.testing.assert_allclose(u[0], 0.05, atol=1e-10)
    np.testing.assert_allclose(u[1], 0.01, atol=1e-10)


def test_a_step_in_surroundings_can_be_differentiated(float64):
    solid = scattered()
    strength = jnp.where(solid, 0.0, 0.1)
    f = without_fluid_in(solid, random_populations())
    inputs = (f, jnp.asarray([1e-3, 2e-3]), jnp.asarray([0.02, 0.01]))
    random = np.random.default_rng(2)
    along = jax.tree.map(lambda x: jnp.asarray(0.01 * random.normal(size=x.shape)), inputs)

    def energy(inputs):
        f, push, velocity = inputs
        around = fluid.Surroundings(push, solid, fluid.Sponge(strength, velocity))
        return sum(jnp.sum(plane**2) for plane in advance(f, around))

    def moved(h):
        return energy(jax.tree.map(lambda x, d: x + h * d, inputs, along))

    products = jax.tree.map(lambda g, d: jnp.sum(g * d), jax.grad(energy)(inputs), along)
    expected = (moved(1e-4) - moved(-1e-4)) / 2e-4
    np.testing.assert_allclose(sum(jax.tree.leaves(products)), expected, rtol=1e-7)
