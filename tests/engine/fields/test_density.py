"""Nodes splatted as Gaussians: closed forms, the periodic box, and the gradient."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import fields

SIZE = (24, 32)


def test_one_node_is_a_gaussian_across_the_seam(dtype):
    at = jnp.asarray([[0.25, 31.5]], dtype)
    found = np.asarray(fields.splat(at, SIZE, 1.5))
    x, y = np.meshgrid(np.arange(24), np.arange(32), indexing="ij")
    dx, dy = (x - 0.25 + 12) % 24 - 12, (y - 31.5 + 16) % 32 - 16
    np.testing.assert_allclose(found, np.exp(-(dx**2 + dy**2) / 4.5), atol=1e-6)


def test_a_node_weighs_the_same_wherever_it_lies(float64):
    at = np.random.default_rng(0).uniform(-50, 50, (20, 2))
    total = fields.splat(jnp.asarray(at), SIZE, 1.5).sum()
    np.testing.assert_allclose(total, 20 * 2 * np.pi * 1.5**2, rtol=1e-7)


def test_a_box_further_on_is_the_same_place(float64):
    at = np.random.default_rng(1).uniform(0, 24, (5, 2))
    shift = np.array([24.0 * 3, -32.0 * 2])
    one, other = (fields.splat(jnp.asarray(a), SIZE, 2.0) for a in (at, at + shift))
    np.testing.assert_allclose(one, other, atol=1e-12)


def test_saturated_density_counts_what_is_covered_once():
    density = jnp.asarray([[0.0, 1e-4, 1.0, 50.0]])
    expected = [[0.0, 1e-4, 1 - np.exp(-1), 1.0]]
    np.testing.assert_allclose(fields.saturated(density), expected, rtol=1e-3)
    assert fields.unsaturated(density) is density


@pytest.mark.parametrize("kind", [fields.saturated, fields.unsaturated])
def test_the_gradient_agrees_with_central_differences(kind, float64):
    random = np.random.default_rng(2)
    at, way = random.uniform(0, 24, (6, 2)), random.normal(size=(6, 2))
    picture = jnp.asarray(random.uniform(size=SIZE))

    def loss(a):
        return jnp.mean((kind(fields.splat(a, SIZE, 1.5)) - picture) ** 2)

    h = 1e-5
    difference = (loss(jnp.asarray(at + h * way)) - loss(jnp.asarray(at - h * way))) / (2 * h)
    slope = jnp.sum(jax.grad(loss)(jnp.asarray(at)) * way)
    np.testing.assert_allclose(slope, difference, rtol=1e-7)
