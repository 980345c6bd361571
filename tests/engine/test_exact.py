"""Elementary functions and inverses in double precision, against the libraries'."""

import math

import numpy as np
import pytest

from microcosmos import bodies, exact

BODIES = {
    "two nodes": bodies.chain(2, 1.0),
    "chain": bodies.chain(9, 1.5),
    "ring": bodies.ring(12, 1.0),
    "star": bodies.star(4, 3, 1.0),
    "pieces": bodies.combined(
        [bodies.chain(4, 1.0), bodies.placed(bodies.tree(3, 3, 2, 1.0, 2.0), (9, 9))]
    ),
}


def test_functions_are_right_to_the_last_digits():
    x = np.concatenate([np.linspace(-7, 7, 1001), np.linspace(-1e5, 1e5, 1001)])
    np.testing.assert_allclose(exact.sine(x), np.sin(x), rtol=0, atol=2e-16)
    np.testing.assert_allclose(exact.cosine(x), np.cos(x), rtol=0, atol=2e-16)
    small = np.linspace(-600, 600, 1201)
    np.testing.assert_allclose(exact.exponential(small), np.exp(small), rtol=5e-16)
    assert exact.exponential(np.array([-1e6])) == 0
    positive = np.geomspace(1e-9, 1e9, 1001)
    np.testing.assert_allclose(exact.logarithm(positive), np.log(positive), rtol=5e-16)
    y, x = np.random.default_rng(0).normal(size=(2, 1000))
    np.testing.assert_allclose(exact.angle(y, x), np.arctan2(y, x), rtol=2e-15)
    np.testing.assert_allclose(exact.length(y, x), np.hypot(y, x), rtol=5e-16)


def test_right_angles_are_those_of_the_library():
    quarters = np.pi / 2 * np.arange(-8, 9)
    expected = [math.cos(x) for x in quarters]
    np.testing.assert_allclose(exact.cosine(quarters), expected, rtol=5e-15)
    y, x = np.array([[0, 1, 0, -1, -0.0, 0], [1, 0, -1, 0, -1, 0.0]])
    np.testing.assert_array_equal(exact.angle(y, x), np.arctan2(y, x))


def test_an_inverse_is_that_of_a_decomposition():
    rows = np.random.default_rng(0).normal(size=(30, 20))
    matrix = rows.T @ rows
    np.testing.assert_allclose(exact.inverse(matrix), np.linalg.inv(matrix), rtol=1e-10)


@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_eigenvectors_are_those_of_the_library(count):
    rows = np.random.default_rng(count).normal(size=(count // 2 + 2, count))
    for matrix in (rows.T @ rows, np.eye(count), np.zeros((count, count))):  # Of low rank too.
        values, vectors = exact.eigenvectors(matrix)
        expected = np.linalg.eigvalsh(matrix)[::-1]
        np.testing.assert_allclose(values, expected, atol=1e-13 * max(expected[0], 1))
        np.testing.assert_allclose(vectors @ vectors.T, np.eye(count), atol=1e-13)
        rebuilt = vectors.T @ np.diag(values) @ vectors
        np.testing.assert_allclose(rebuilt, matrix, atol=1e-12 * max(expected[0], 1))


@pytest.mark.parametrize("name", BODIES)
def test_layouts_have_the_pseudoinverses_of_their_differences(name):
    body = BODIES[name]
    found = bodies.layout(body)
    for pairs, inverse in ((body.edges, found.placed), (body.joints, found.turned)):
        differences = np.zeros((len(pairs), len(inverse)))
        rows = np.arange(len(pairs))
        differences[rows, pairs[:, 1]] = 1
        differences[rows, pairs[:, 0]] = -1
        np.testing.assert_allclose(inverse, np.linalg.pinv(differences), atol=1e-12)
