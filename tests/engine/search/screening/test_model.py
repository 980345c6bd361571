"""The model: its recursion beside the closed form, what it learns, and its errors."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos.search.screening import READY, Regression, learned
from microcosmos.search.screening.model import RIDGE, WINDOW

INPUTS, OUTPUTS = 6, 2


@pytest.fixture
def regression():
    return Regression(INPUTS, OUTPUTS, jax.random.key(3))


def samples(count, seed=0):
    rng = np.random.default_rng(seed)
    inputs = rng.normal(size=(count, INPUTS)).astype(np.float32) * 3 + 1
    wave = np.sin(inputs[:, 0]) + 0.5 * inputs[:, 1]
    return inputs, np.stack([wave, np.abs(inputs[:, 2])], 1)


@pytest.mark.long
def test_recursive_least_squares_is_ridge_regression(regression):
    inputs, outputs = samples(READY + 40)
    model = learned(regression, regression.init(), inputs[:READY], outputs[:READY])
    for row in range(READY, READY + 40, 8):
        rows = slice(row, row + 8)
        model = learned(regression, model, inputs[rows], outputs[rows])
    phi = np.asarray(regression.basis(jnp.asarray(inputs), model), float)
    y = (outputs - model.level) / model.spread
    closed = np.linalg.solve(phi.T @ phi + RIDGE * np.eye(phi.shape[1]), phi.T @ y)
    np.testing.assert_allclose(model.weights, closed, atol=1e-6)
    assert model.count == READY + 40


def test_the_first_evaluations_set_the_scales_however_they_arrive(regression):
    inputs, outputs = samples(READY)
    at_once = learned(regression, regression.init(), inputs, outputs)
    model = regression.init()
    for rows in np.array_split(np.arange(READY), 7):
        assert not model.ready
        model = learned(regression, model, inputs[rows], outputs[rows])
    assert model.ready
    np.testing.assert_allclose(model.middle, inputs.mean(0), rtol=1e-6)
    np.testing.assert_allclose(model.scale, inputs.std(0), rtol=1e-5)
    jax.tree.map(np.testing.assert_array_equal, model, at_once)


@pytest.mark.long
def test_it_is_learned_anew_from_the_newest_whenever_evaluations_double(regression):
    inputs, outputs = samples(4 * READY)
    inputs[READY:] *= 0.1  # Later creatures differ less.
    model, scales = regression.init(), []
    for rows in np.array_split(np.arange(4 * READY), 16):
        model = learned(regression, model, inputs[rows], outputs[rows])
        scales.append(model.scale[0])
    assert len(set(scales[3:])) == 3
    np.testing.assert_allclose(model.scale, inputs.std(0), rtol=1e-5)
    at_once = learned(regression, regression.init(), inputs, outputs)
    np.testing.assert_allclose(model.weights, at_once.weights, atol=1e-9)


@pytest.mark.long
def test_old_evaluations_are_forgotten(regression):
    rows = WINDOW + 100
    model = learned(regression, regression.init(), *samples(rows))
    assert model.count == rows
    assert len(model.inputs) == len(model.outputs) == WINDOW
    np.testing.assert_array_equal(model.inputs, samples(rows)[0][100:])
