"""The fluid: conservation, walls, sponges, and the adjoint of a collision."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fluid
from microcosmos.fluid.adjoint import collision
from microcosmos.fluid.lattice import DIRECTIONS

SIZE = (12, 10)
NO_FORCE = np.zeros((2, *SIZE))


def random_populations(dtype="float64"):
    random = np.random.default_rng(0)
    return tuple(jnp.asarray(random.uniform(-0.01, 0.01, SIZE), dtype) for _ in range(9))


@jax.jit
def step(f, force, rates):
    return fluid.stream(fluid.collide(f, fluid.density(f), fluid.momentum(f), force, rates))


def test_collision_keeps_momentum_in_every_cell_but_for_the_force(float64):
    f, rates = random_populations(), fluid.rates(jnp.asarray(0.02))
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


def test_one_step_can_be_differentiated(require_slope, float64):
    inputs = (random_populations(), jnp.full((2, *SIZE), 1e-3), jnp.asarray(0.1))

    def energy(inputs):
        f, force, viscosity = inputs
        return sum(jnp.sum(plane**2) for plane in step(f, force, fluid.rates(viscosity)))

    require_slope(energy, inputs, rtol=1e-7)


def advance(f, surroundings):
    rates, force = fluid.rates(jnp.asarray(0.05)), jnp.asarray(NO_FORCE)
    return fluid.advance(f, fluid.density(f), fluid.momentum(f), force, rates, surroundings)


def scattered():
    """Cells of wall strewn over the box, corners and the seam among them."""
    return jnp.asarray(np.random.default_rng(3).random(SIZE) < 0.3)


def without_fluid_in(solid, f):
    return tuple(jnp.where(solid, 0.0, plane) for plane in f)


@pytest.mark.fast
def test_empty_surroundings_compile_to_collision_and_streaming_alone(float64):
    f = random_populations()

    def plain(f):
        rates, force = fluid.rates(jnp.asarray(0.05)), jnp.asarray(NO_FORCE)
        rho, momentum = fluid.density(f), fluid.momentum(f)
        return fluid.stream(collision(f, rho, momentum, force, rates))

    def advanced(f):
        return advance(f, fluid.Surroundings())

    assert str(jax.make_jaxpr(advanced)(f)) == str(jax.make_jaxpr(plain)(f))


@pytest.mark.parametrize("direction", range(1, 9))
def test_walls_reverse_populations(direction, float64):
    solid = jnp.zeros(SIZE, bool).at[5, 5].set(True)
    f, surroundings = random_populations(), fluid.Surroundings(solid=solid)
    f = without_fluid_in(solid, f)
    rates = fluid.rates(jnp.asarray(0.05))
    now = (f, fluid.density(f), fluid.momentum(f), jnp.asarray(NO_FORCE))
    collided = fluid.collide(*now, rates)
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
    assert abs(float(jnp.sum(jnp.stack(f)) - jnp.sum(jnp.stack(start)))) <= 1e-14
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


def test_a_step_in_surroundings_can_be_differentiated(require_slope, float64):
    solid = scattered()
    strength = jnp.where(solid, 0.0, 0.1)
    f = without_fluid_in(solid, random_populations())
    inputs = (f, jnp.asarray([1e-3, 2e-3]), jnp.asarray([0.02, 0.01]))

    def energy(inputs):
        f, push, velocity = inputs
        around = fluid.Surroundings(push, solid, fluid.Sponge(strength, velocity))
        return sum(jnp.sum(plane**2) for plane in advance(f, around))

    require_slope(energy, inputs, rtol=1e-7)


def test_the_adjoint_is_that_of_automatic_differentiation(float64):
    random = np.random.default_rng(0)

    def planes(count, size):
        return tuple(jnp.asarray(size * random.normal(size=(5, 7))) for _ in range(count))

    f, force = planes(9, 0.02), jnp.stack(planes(2, 1e-3))
    given = (f, fluid.density(f), fluid.momentum(f), force, fluid.rates(jnp.asarray(0.07)))
    cotangent = planes(9, 1.0)
    out, pull = jax.vjp(fluid.collide, *given)
    same, own = jax.vjp(collision, *given)
    jax.tree.map(np.testing.assert_array_equal, same, out)
    expected, found = pull(cotangent), own(cotangent)
    assert jax.tree.structure(found) == jax.tree.structure(expected)
    near = partial(np.testing.assert_allclose, rtol=1e-12, atol=1e-12)
    jax.tree.map(near, found, expected)
