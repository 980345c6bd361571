"""Energy, density and repulsion as planes: closed forms, sums, gradients."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import coupling, fields

SIZE = (32, 24)
splat = jax.jit(fields.splat, static_argnums=(1, 2))


@pytest.mark.parametrize("width", [1.0, 4.0, 64.0])
def test_a_periodic_box_holds_all_of_every_packet(width):
    what = fields.Packets(count=5, width=width, amplitude=0.3, seed=1)
    # Cells sample a Gaussian of a cell's width to 1e-8 (Poisson's sum).
    expected = 5 * 0.3 * 2 * np.pi * width**2
    assert fields.packets(SIZE, what).sum() == pytest.approx(expected, rel=1e-6)


def test_the_seed_alone_decides_where_packets_are():
    seeded = [fields.Packets(4, 2.0, 1.0, seed) for seed in (7, 7, 8)]
    one, same, other = (fields.packets(SIZE, packets) for packets in seeded)
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1


def test_diffusion_keeps_the_sum_and_spreads_by_two_d_t(float64):
    rate, steps = 0.2, 60
    plane = np.zeros((64, 64))
    plane[32, 32] = 1.0
    diffuse = jax.jit(fields.diffuse)
    for _ in range(steps):
        plane = diffuse(plane, np.asarray(rate))
    plane = np.asarray(plane)
    away = np.arange(64) - 32
    assert float(plane.sum()) == pytest.approx(1, rel=1e-12)
    assert float(plane.min()) >= 0
    for axis in range(2):
        variance = np.sum(away**2 * np.asarray(plane.sum(1 - axis)))
        assert variance == pytest.approx(2 * rate * steps, rel=1e-6)


def test_a_wave_diffuses_at_the_rate_of_the_stencil(float64):
    k, rate = 2 * np.pi * 3 / SIZE[0], 0.25
    wave = np.tile(np.cos(k * np.arange(SIZE[0]))[:, None], SIZE[1])
    expected = (1 - 2 * rate * (1 - np.cos(k))) * wave
    np.testing.assert_allclose(
        jax.jit(fields.diffuse)(wave, np.asarray(rate)), expected, atol=1e-14
    )


@pytest.mark.parametrize("rate", [0.1, 1.0])
def test_nodes_together_take_at_most_all_there_is(rate, float64):
    random = np.random.default_rng(0)
    field = jnp.asarray(random.uniform(0, 2, SIZE))
    coverage = jnp.asarray(random.exponential(3.0, SIZE) * (random.random(SIZE) < 0.5))
    left, share = fields.collect(field, coverage, jnp.asarray(rate))
    np.testing.assert_allclose(left + share * coverage, field, rtol=1e-12)
    assert float(left.min()) >= -1e-15
    bare = np.asarray(coverage) == 0
    np.testing.assert_array_equal(np.asarray(left)[bare], np.asarray(field)[bare])
    sparse = np.asarray(rate * coverage) <= 1
    np.testing.assert_allclose(np.asarray(share)[sparse], rate * np.asarray(field)[sparse])


def test_one_node_is_a_gaussian_across_the_seam(dtype):
    found = np.asarray(splat(np.asarray([[31.5, 0.25]], dtype), SIZE, 1.5))
    x, y = np.meshgrid(np.arange(32), np.arange(24), indexing="ij")
    dx, dy = (x - 31.5 + 16) % 32 - 16, (y - 0.25 + 12) % 24 - 12
    np.testing.assert_allclose(found, np.exp(-(dx**2 + dy**2) / 4.5), atol=1e-6)


def test_saturated_density_counts_what_is_covered_once():
    density = jnp.asarray([[0.0, 1e-4, 1.0, 50.0]])
    expected = [[0.0, 1e-4, 1 - np.exp(-1), 1.0]]
    np.testing.assert_allclose(fields.saturated(density), expected, rtol=1e-3)
    assert fields.unsaturated(density) is density


@pytest.mark.parametrize("kind", [fields.saturated, fields.unsaturated])
def test_densities_can_be_differentiated(kind, require_slope, float64):
    random = np.random.default_rng(2)
    positions = jnp.asarray(random.uniform(0, 24, (6, 2)))
    picture = jnp.asarray(random.uniform(size=SIZE))

    def loss(positions):
        return jnp.mean((kind(fields.splat(positions, SIZE, 1.5)) - picture) ** 2)

    require_slope(loss, positions, h=1e-5, rtol=1e-7)


BOTH = pytest.mark.parametrize("gradient", [fields.gaussian, fields.binomial])


def response(gradient, kx, ky):
    """Factors of a wave: of its smoothing, and of its slopes along x and y."""
    if gradient is fields.gaussian:
        return np.exp(-(kx**2 + ky**2) / 2), kx, ky
    return (np.cos(kx / 2) * np.cos(ky / 2)) ** 4, np.sin(kx), np.sin(ky)


@partial(jax.jit, static_argnums=0)
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
    found = jax.jit(gradient)(np.cos(kx * x + ky * y))
    wave = -smoothed * np.sin(kx * x + ky * y)
    np.testing.assert_allclose(found, np.stack([slope_x * wave, slope_y * wave]), atol=1e-13)


@BOTH
@pytest.mark.parametrize("size", [(32, 24), (33, 25)])
def test_the_sharpest_wave_has_no_slope(gradient, size, float64):
    x, y = np.meshgrid(*(np.arange(side) for side in size), indexing="ij")
    even = (x % 2 == 0) & (y % 2 == 0) if size[0] % 2 else (x + y) % 2 == 0
    found = jax.jit(gradient)(np.where(even, 1.0, -1.0))
    assert np.all(np.isfinite(found))
    if size[0] % 2 == 0:
        np.testing.assert_allclose(found, 0, atol=1e-13)


@BOTH
def test_displacements_of_any_nodes_sum_to_zero(gradient, float64):
    positions = np.random.default_rng(0).uniform(-40, 40, (50, 2))
    found = slope_at(gradient, positions)
    assert np.abs(found).max() > 0.05
    np.testing.assert_allclose(np.sum(found, 0), 0, atol=1e-13)


@BOTH
@pytest.mark.parametrize("gap", [1, 2, 3])
def test_lines_repel_by_the_slope_of_the_smoothing(gradient, gap, float64):
    # Lines with a node a cell, all on the grid, where a Gaussian is ρ(y) = exp(−y²/2) / √(2π).
    x = np.arange(SIZE[0])
    lines = [np.stack([x, np.full(len(x), 8.0 + y)], 1) for y in (0, gap)]
    found = np.asarray(slope_at(gradient, np.concatenate(lines)))
    expected, off = gap * np.exp(-(gap**2) / 2) / np.sqrt(2 * np.pi), 0.01
    if gradient is fields.binomial:
        expected, off = (5 / 32, 4 / 32, 1 / 32)[gap - 1], 1e-14
    np.testing.assert_allclose(found[: len(x), 1], expected, atol=off)
    np.testing.assert_allclose(found[len(x) :, 1], -expected, atol=off)
    np.testing.assert_allclose(found[:, 0], 0, atol=1e-14)


def test_no_displacement_is_longer_than_the_limit(float64):
    given = np.random.default_rng(0).normal(size=(40, 2))
    found = np.asarray(jax.jit(fields.capped)(given, np.asarray(0.8)))
    before, after = np.hypot(*given.T), np.hypot(*found.T)
    assert np.any(before < 0.8)
    np.testing.assert_allclose(after, np.minimum(before, 0.8), rtol=1e-12)
    np.testing.assert_allclose(found[:, 0] * given[:, 1], found[:, 1] * given[:, 0])


def test_the_cap_has_a_gradient_at_nothing(dtype):
    def total(given):
        return jnp.sum(fields.capped(given, jnp.asarray(0.1, dtype)))

    np.testing.assert_array_equal(jax.jit(jax.grad(total))(np.zeros((3, 2), dtype)), 1)


@BOTH
def test_repulsion_can_be_differentiated(gradient, require_slope, float64):
    random = np.random.default_rng(2)
    positions = jnp.asarray(random.uniform(8, 14, (12, 2)))
    weights = jnp.asarray(random.normal(size=positions.shape))

    def total(positions):
        return jnp.sum(weights * slope_at(gradient, positions))

    require_slope(total, positions, rtol=1e-7)
