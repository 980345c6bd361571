"""Repulsion through the smoothed density: closed forms, sums, caps."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling, fields

SIZE = (32, 24)
BOTH = pytest.mark.parametrize("gradient", [fields.gaussian, fields.binomial])


def response(gradient, kx, ky):
    """What a wave is multiplied by when it is smoothed, and by its slopes along x and y."""
    if gradient is fields.gaussian:
        return np.exp(-(kx**2 + ky**2) / 2), kx, ky
    return (np.cos(kx / 2) * np.cos(ky / 2)) ** 4, np.sin(kx), np.sin(ky)


def slope_at(gradient, positions, strength=1.0):
    at = coupling.windows(positions, SIZE, coupling.HAT)
    density = coupling.spread(jnp.ones_like(positions[:, :1]), at, SIZE)[0]
    return strength * coupling.interpolate(gradient(density), at)


@BOTH
@pytest.mark.parametrize(("m", "n"), [(1, 0), (0, 2), (3, 5), (7, -4)])
def test_a_wave_keeps_its_form(gradient, m, n, float64):
    kx, ky = 2 * np.pi * m / SIZE[0], 2 * np.pi * n / SIZE[1]
    x, y = np.meshgrid(*(np.arange(side) for side in SIZE), indexing="ij")
    smoothed, slope_x, slope_y = response(gradient, kx, ky)
    found = gradient(jnp.asarray(np.cos(kx * x + ky * y)))
    wave = -smoothed * np.sin(kx * x + ky * y)
    np.testing.assert_allclose(found, np.stack([slope_x * wave, slope_y * wave]), atol=1e-13)


@BOTH
@pytest.mark.parametrize("size", [(32, 24), (33, 25)])
def test_the_sharpest_wave_has_no_slope(gradient, size, float64):
    x, y = np.meshgrid(*(np.arange(side) for side in size), indexing="ij")
    even = (x % 2 == 0) & (y % 2 == 0) if size[0] % 2 else (x + y) % 2 == 0
    found = gradient(jnp.asarray(np.where(even, 1.0, -1.0)))
    assert np.all(np.isfinite(found))
    if size[0] % 2 == 0:
        np.testing.assert_allclose(found, 0, atol=1e-13)


@BOTH
def test_displacements_of_any_nodes_sum_to_zero(gradient, float64):
    positions = np.random.default_rng(0).uniform(-40, 40, (50, 2))
    found = slope_at(gradient, jnp.asarray(positions))
    assert np.abs(found).max() > 0.05
    np.testing.assert_allclose(jnp.sum(found, 0), 0, atol=1e-13)


@BOTH
@pytest.mark.parametrize("gap", [1, 2, 3])
def test_lines_repel_by_the_slope_of_the_smoothing(gradient, gap, float64):
    # Lines with a node a cell, all on the grid, where a Gaussian is ρ(y) = exp(−y²/2) / √(2π).
    x = np.arange(SIZE[0])
    lines = [np.stack([x, np.full(len(x), 8.0 + y)], 1) for y in (0, gap)]
    found = slope_at(gradient, jnp.asarray(np.concatenate(lines)))
    expected, off = gap * np.exp(-(gap**2) / 2) / np.sqrt(2 * np.pi), 0.01
    if gradient is fields.binomial:
        expected, off = (5 / 32, 4 / 32, 1 / 32)[gap - 1], 1e-14
    np.testing.assert_allclose(found[: len(x), 1], expected, atol=off)
    np.testing.assert_allclose(found[len(x) :, 1], -expected, atol=off)
    np.testing.assert_allclose(found[:, 0], 0, atol=1e-14)


def test_no_displacement_is_longer_than_the_limit(float64):
    given = jnp.asarray(np.random.default_rng(0).normal(size=(40, 2)))
    found = fields.capped(given, jnp.asarray(0.8))
    before, after = np.hypot(*given.T), np.hypot(*found.T)
    assert np.any(before < 0.8)
    np.testing.assert_allclose(after, np.minimum(before, 0.8), rtol=1e-12)
    np.testing.assert_allclose(found[:, 0] * given[:, 1], found[:, 1] * given[:, 0])


def test_the_cap_has_a_gradient_at_nothing(dtype):
    def total(given):
        return jnp.sum(fields.capped(given, jnp.asarray(0.1, dtype)))

    np.testing.assert_array_equal(jax.grad(total)(jnp.zeros((3, 2), dtype)), 1)


@BOTH
def test_repulsion_can_be_differentiated(gradient, float64):
    random = np.random.default_rng(2)
    positions = jnp.asarray(random.uniform(8, 14, (12, 2)))
    along = jnp.asarray(random.normal(size=positions.shape))
    weights = jnp.asarray(random.normal(size=positions.shape))

    @jax.jit
    def total(positions):
        return jnp.sum(weights * slope_at(gradient, positions))

    slope, h = jnp.sum(jax.grad(total)(positions) * along), 1e-6
    difference = (total(positions + h * along) - total(positions - h * along)) / (2 * h)
    np.testing.assert_allclose(slope, difference, rtol=1e-7)
