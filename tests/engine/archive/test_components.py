"""Principal components of measures, against a decomposition of the library's."""

import numpy as np
import pytest

from microcosmos.archive import components
from microcosmos.archive.axes import floors

WIDE = np.random.default_rng(0).normal(size=(300, 5)) @ np.random.default_rng(1).normal(
    size=(5, 12)
) + 0.3 * np.random.default_rng(2).normal(size=(300, 12))


def standard(values):
    return np.clip((values - values.mean(0)) / values.std(0), -3, 3)


def test_axes_are_the_singular_vectors_of_standardised_measures():
    found = components.learn(WIDE, 3)
    rows = standard(WIDE)
    _, size, vectors = np.linalg.svd(rows - rows.mean(0), full_matrices=False)
    along = np.abs(np.sum(found.weights * vectors[:3], 1))
    np.testing.assert_allclose(along, 1, rtol=1e-10)
    np.testing.assert_allclose(found.explained, (size**2 / np.sum(size**2))[:3], rtol=1e-10)
    np.testing.assert_allclose(found.coordinates(WIDE), rows @ found.weights.T, atol=1e-12)
    largest = np.argmax(np.abs(found.weights), 1)
    assert (found.weights[np.arange(3), largest] > 0).all()


def test_units_and_order_of_measures_make_no_difference():
    found, order = components.learn(WIDE, 2), np.random.default_rng(3).permutation(12)
    other = components.learn(((WIDE + 5) * np.geomspace(1e-6, 1e6, 12))[:, order], 2)
    np.testing.assert_allclose(other.weights, found.weights[:, order], atol=1e-6)


def test_constant_and_unknown_measures_do_not_count():
    values = WIDE.copy()
    values[:, 2], values[7, 4], values[8, 5] = 0.1, np.nan, np.inf
    found = components.learn(values, 2)
    assert not found.scale[[2, 4, 5]].any()
    assert not found.weights[:, [2, 4, 5]].any()
    rest = np.delete(np.arange(12), [2, 4, 5])
    alone = components.learn(WIDE[:, rest], 2)
    np.testing.assert_allclose(found.weights[:, rest], alone.weights, atol=1e-12)
    assert np.isfinite(found.coordinates(values)).all()


@pytest.mark.parametrize("rows", [np.ones((6, 3)), np.arange(6.0)[:, None] * np.ones((6, 3))])
def test_axes_without_variance_are_not_empty(rows):
    found = components.learn(rows, 3)
    assert (found.high - found.low > 1e-4).all()
    assert np.isfinite(found.coordinates(rows)).all()
    assert np.isfinite(found.explained).all()


def test_logarithms_end_at_a_least_value():
    least = floors(("power", "speed", "some:plugin"))
    assert least == pytest.approx((1e-9, 0.0, 0.0))
    measures = np.array([[0.0, 1, 2], [1e-3, 3, 4], [np.nan, 5, 6]], np.float32)
    found = components.scaled(measures, least)
    np.testing.assert_allclose(found[:2, 0], np.log([1e-9, 1e-3]), rtol=1e-7)
    assert np.isnan(found[2, 0])
    np.testing.assert_array_equal(found[:, 1:], measures[:, 1:])
