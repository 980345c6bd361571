"""Roma's three-point delta and linear interpolation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling

KERNELS = pytest.mark.parametrize(
    "kernel", [coupling.ROMA, coupling.HAT, coupling.PESKIN], ids=lambda k: k.weight.__name__
)


def around(points):
    """Distances of the nearest cells, and one more to each side, from anywhere in a cell."""
    return jnp.asarray(np.linspace(-0.5, 0.5, 101)[:, None] + np.arange(-points, points + 1.0))


@KERNELS
def test_weights_sum_to_one_wherever_the_point_is(kernel, float64):
    weights = kernel.weight(around(kernel.points))
    np.testing.assert_allclose(jnp.sum(weights, 1), 1, rtol=1e-14)


@KERNELS
def test_weights_have_no_first_moment(kernel, float64):
    r = around(kernel.points)
    np.testing.assert_allclose(jnp.sum(r * kernel.weight(r), 1), 0, atol=1e-14)


def test_the_sum_of_squares_of_the_three_point_delta_is_a_half(float64):
    # The condition from which Roma, Peskin and Berger (1999) have it.
    np.testing.assert_allclose(jnp.sum(coupling.roma(around(3)) ** 2, 1), 0.5, rtol=1e-13)


@KERNELS
def test_a_delta_is_even_and_ends_where_its_points_do(kernel, float64):
    r = jnp.linspace(0, 3, 61)
    weights = np.asarray(kernel.weight(r))
    np.testing.assert_array_equal(kernel.weight(-r), weights)
    ends = np.asarray(r) >= kernel.points / 2
    assert np.all(weights[ends] == 0)
    assert np.all(weights[~ends] > 0)


@KERNELS
def test_gradients_are_finite_at_every_seam(kernel, dtype):
    r = jnp.asarray([-2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 3, 1e-30, 1.5 - 1e-6], dtype)
    assert np.all(np.isfinite(jax.vmap(jax.grad(kernel.weight))(r)))


@KERNELS
def test_gradients_agree_with_finite_differences_between_seams(kernel, float64):
    r = jnp.asarray([-1.9, -1.2, -0.7, -0.3, 0.05, 0.45, 0.55, 0.95, 1.05, 1.45, 1.55, 2.5])
    slope, h = jax.vmap(jax.grad(kernel.weight))(r), 1e-6
    difference = (kernel.weight(r + h) - kernel.weight(r - h)) / (2 * h)
    np.testing.assert_allclose(slope, difference, atol=1e-8)


@KERNELS
def test_windows_hold_every_cell_of_the_support(kernel, float64):
    size = (16, 12)
    points = np.random.default_rng(0).uniform(-20, 20, (30, 2))
    points = np.concatenate([points, [[3.0, 4.0], [3.5, 4.5]]])

    @jax.jit
    def covered(points):
        at = coupling.windows(points, size, kernel)
        return coupling.spread(jnp.eye(len(points)), at, size)

    found = covered(jnp.asarray(points))
    for axis, side in enumerate(size):
        away = np.arange(side)[None] - points[:, axis, None]
        away = away - side * np.round(away / side)
        expected = kernel.weight(jnp.asarray(away))
        np.testing.assert_allclose(jnp.sum(found, 2 - axis), expected, atol=1e-13)
