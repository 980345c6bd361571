"""Sums over the bodies of a world."""

import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import groups

pytestmark = pytest.mark.fast

MEMBER = np.repeat([0, 1, 2], [3, 1, 4])
VALUES = np.random.default_rng(0).normal(size=(8, 2)).astype(np.float32)


@pytest.fixture
def three():
    return groups.Groups(jnp.asarray(MEMBER), 3)


def test_sums_maxima_and_values_are_those_of_each_body(three):
    values = [VALUES[body == MEMBER] for body in range(3)]
    sums, maxima = [own.sum(0) for own in values], [own[:, 0].max() for own in values]
    np.testing.assert_allclose(three.total(jnp.asarray(VALUES)), sums, rtol=1e-6)
    np.testing.assert_array_equal(three.largest(jnp.asarray(VALUES[:, 0])), maxima)
    found = three.per_node(jnp.asarray([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]))
    np.testing.assert_array_equal(found, np.stack([2 * MEMBER + 1, 2 * MEMBER + 2], 1))


def test_one_body_has_the_sums_of_all_nodes():
    alone, values = groups.single(8), jnp.asarray(VALUES)
    np.testing.assert_allclose(alone.total(values)[0], VALUES.sum(0), rtol=1e-6)
    np.testing.assert_array_equal(alone.largest(values[:, 0])[0], VALUES[:, 0].max())
    np.testing.assert_array_equal(alone.per_node(values[:1]), np.repeat(VALUES[:1], 8, 0))


def test_points_beside_a_node_are_of_its_body(three):
    twice = three.repeated(2)
    np.testing.assert_array_equal(twice.member, np.repeat(MEMBER, 2))
    np.testing.assert_allclose(twice.total(jnp.ones(16)), [6, 2, 8])
