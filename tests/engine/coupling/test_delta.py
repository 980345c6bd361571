"""Peskin's delta and the transfer between nodes and cells."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling

SIZE = (16, 12)


@pytest.fixture
def samples(float64):
    """Distances of the four nearest cells from nodes anywhere between two cells."""
    shift = np.linspace(0, 1, 101)[:, None]
    return jnp.asarray(shift + np.array([-2.0, -1.0, 0.0, 1.0]))


@pytest.fixture
def nodes(float64):
    """Nodes inside the box, across its border and boxes away from it."""
    spread_out = np.random.default_rng(0).uniform(-40, 40, (30, 2))
    corners = [[0, 0], [-0.3, 11.9], [15.99, 0.01], [5, 5], [5.5, 5.5]]
    return jnp.asarray(np.concatenate([spread_out, corners]))


def interpolate(plane, at):
    return coupling.interpolate(plane[None], at)[:, 0]


def test_the_delta_is_a_partition_of_unity(samples):
    np.testing.assert_allclose(jnp.sum(coupling.peskin(samples), 1), 1, rtol=1e-14)


def test_the_delta_has_no_first_moment(samples):
    moment = jnp.sum(samples * coupling.peskin(samples), 1)
    np.testing.assert_allclose(moment, 0, atol=1e-14)


def test_even_and_odd_cells_have_half_of_the_delta_each(samples):
    delta = coupling.peskin(samples)
    np.testing.assert_allclose(delta[:, 0] + delta[:, 2], 0.5, rtol=1e-14)


def test_the_sum_of_the_squared_delta_is_three_eighths(samples):
    np.testing.assert_allclose(jnp.sum(coupling.peskin(samples) ** 2, 1), 3 / 8, rtol=1e-14)


def test_the_delta_is_even_and_ends_at_two_cells(float64):
    r = jnp.linspace(0, 3, 61)
    np.testing.assert_array_equal(coupling.peskin(-r), coupling.peskin(r))
    assert np.all(np.asarray(coupling.peskin(r))[r >= 2] == 0)


def test_the_gradient_of_the_delta_is_finite_everywhere(dtype):
    r = jnp.asarray([-3, -2, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 1e-30, 2 - 1e-6], dtype)
    for count in (1, 2):
        slope = coupling.peskin
        for _ in range(count):
            slope = jax.grad(slope)
        assert np.all(np.isfinite(jax.vmap(slope)(r)))


def test_the_gradient_of_the_delta_agrees_with_finite_differences(float64):
    # Away from 0, 1 and 2, where the second derivative jumps.
    r = jnp.asarray([-1.9, -1.2, -0.7, -0.1, 0.05, 0.5, 0.95, 1.05, 1.5, 1.95, 2.5])
    slope, h = jax.vmap(jax.grad(coupling.peskin))(r), 1e-5
    difference = (coupling.peskin(r + h) - coupling.peskin(r - h)) / (2 * h)
    np.testing.assert_allclose(slope, difference, atol=1e-8)


def test_interpolation_is_the_transpose_of_spreading(nodes):
    random = np.random.default_rng(1)
    at = coupling.windows(nodes, SIZE)
    field = jnp.asarray(random.normal(size=(2, *SIZE)))
    values = jnp.asarray(random.normal(size=nodes.shape))
    interpolated = jnp.stack([interpolate(plane, at) for plane in field], 1)
    spread = coupling.spread(values, at, SIZE)
    np.testing.assert_allclose(
        jnp.sum(spread * field), jnp.sum(values * interpolated), rtol=1e-12
    )


def test_spreading_keeps_the_sum(nodes):
    values = jnp.asarray(np.random.default_rng(1).normal(size=nodes.shape))
    spread = coupling.spread(values, coupling.windows(nodes, SIZE), SIZE)
    np.testing.assert_allclose(jnp.sum(spread, (1, 2)), jnp.sum(values, 0), atol=1e-12)


def test_interpolation_is_exact_for_linear_fields(float64):
    positions = jnp.asarray(np.random.default_rng(0).uniform(3, 8, (20, 2)))
    x, y = jnp.meshgrid(jnp.arange(16.0), jnp.arange(12.0), indexing="ij")
    at = coupling.windows(positions, SIZE)
    expected = 1 + 2 * positions[:, 0] - 3 * positions[:, 1]
    np.testing.assert_allclose(interpolate(1 + 2 * x - 3 * y, at), expected, rtol=1e-12)


def test_a_node_acts_on_the_same_cells_from_every_image_of_the_box(nodes):
    values = jnp.asarray(np.random.default_rng(1).normal(size=nodes.shape))
    images = nodes + jnp.asarray([[-3.0 * SIZE[0], 2.0 * SIZE[1]]])
    here, there = (
        coupling.spread(values, coupling.windows(x, SIZE), SIZE) for x in (nodes, images)
    )
    np.testing.assert_allclose(there, here, atol=1e-12)


def test_a_node_on_the_border_reaches_across_it(float64):
    at = coupling.windows(jnp.asarray([[0.0, 11.5]]), SIZE)
    spread = coupling.spread(jnp.ones((1, 2)), at, SIZE)[0]
    x, y = np.nonzero(np.asarray(spread))
    assert set(x) == {15, 0, 1}
    assert set(y) == {10, 11, 0, 1}


def test_interpolation_can_be_differentiated_by_position(float64):
    positions = jnp.asarray(np.random.default_rng(0).uniform(0, 12, (5, 2)))
    field = jnp.asarray(np.random.default_rng(1).normal(size=SIZE))

    @jax.jit
    def total(positions):
        return jnp.sum(interpolate(field, coupling.windows(positions, SIZE)) ** 2)

    direction = jnp.asarray(np.random.default_rng(2).normal(size=positions.shape))
    slope, h = jnp.sum(jax.jit(jax.grad(total))(positions) * direction), 1e-5
    difference = (total(positions + h * direction) - total(positions - h * direction)) / (2 * h)
    np.testing.assert_allclose(slope, difference, rtol=1e-7)
