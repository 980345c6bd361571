"""Packets of energy, their diffusion, and what is taken of them."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fields

SIZE = (32, 24)


@pytest.mark.parametrize("width", [1.0, 4.0, 64.0])
def test_a_periodic_box_holds_all_of_every_packet(width):
    what = fields.Packets(count=5, width=width, amplitude=0.3, seed=1)
    # Cells sample a Gaussian of a cell's width to 1e-8 (Poisson's sum).
    expected = 5 * 0.3 * 2 * np.pi * width**2
    assert fields.packets(SIZE, what).sum() == pytest.approx(expected, rel=1e-6)


def test_packets_go_on_across_the_border():
    # Far wider than the box they are level, and level across the border too.
    plane = fields.packets(SIZE, fields.Packets(3, 20.0, 1.0, 0))
    inside = np.abs(np.diff(plane, axis=0)).max()
    across = np.abs(plane[0] - plane[-1]).max()
    assert across <= 1.01 * inside


def test_the_seed_alone_decides_where_packets_are():
    one, same, other = (
        fields.packets(SIZE, fields.Packets(4, 2.0, 1.0, seed)) for seed in (7, 7, 8)
    )
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 0.1


def test_diffusion_keeps_the_sum_and_spreads_by_two_d_t(float64):
    rate, steps = 0.2, 60
    plane = jnp.zeros((64, 64)).at[32, 32].set(1.0)
    for _ in range(steps):
        plane = fields.diffuse(plane, jnp.asarray(rate))
    away = np.arange(64) - 32
    assert float(plane.sum()) == pytest.approx(1, rel=1e-12)
    assert float(plane.min()) >= 0
    for axis in range(2):
        variance = np.sum(away**2 * np.asarray(plane.sum(1 - axis)))
        assert variance == pytest.approx(2 * rate * steps, rel=1e-6)


def test_a_wave_diffuses_at_the_rate_of_the_stencil(float64):
    k, rate = 2 * np.pi * 3 / SIZE[0], 0.25
    wave = jnp.asarray(np.tile(np.cos(k * np.arange(SIZE[0]))[:, None], SIZE[1]))
    expected = 1 - 2 * rate * (1 - np.cos(k))
    np.testing.assert_allclose(
        fields.diffuse(wave, jnp.asarray(rate)), expected * wave, atol=1e-14
    )


@pytest.mark.parametrize("rate", [0.1, 1.0])
def test_nodes_together_take_at_most_all_there_is(rate, float64):
    random = np.random.default_rng(0)
    field = jnp.asarray(random.uniform(0, 2, SIZE))
    coverage = jnp.asarray(random.exponential(3.0, SIZE) * (random.random(SIZE) < 0.5))
    left, share = fields.collect(field, coverage, jnp.asarray(rate))
    np.testing.assert_allclose(left + share * coverage, field, rtol=1e-12)
    assert float(left.min()) >= -1e-15
    np.testing.assert_array_equal(
        np.asarray(left)[np.asarray(coverage) == 0], field[coverage == 0]
    )
    sparse = np.asarray(rate * coverage) <= 1
    np.testing.assert_allclose(np.asarray(share)[sparse], rate * np.asarray(field)[sparse])
