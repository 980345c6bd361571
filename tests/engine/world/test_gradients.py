"""Gradients through network, development, body and fluid at once."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, world
from microcosmos.build import build_controls
from microcosmos.spec import Control

STEPS, SIZE, VISCOSITY = 200, (48, 48), 0.1

H = 1e-5
"""Step of the finite differences: their error was 2e-9 here and from 1e-4 on it grows."""


@pytest.fixture
def network():
    """A function that makes a CPPN with one hidden node, smooth everywhere."""

    def cppn(dtype):
        genes = genomes.empty(8, 16)
        names = {name: number for number, name in enumerate(genomes.ACTIVATIONS)}
        links = [(0, 3), (1, 3), (2, 3), (1, 4), (2, 4), (0, 5), (1, 5), (5, 3), (5, 4)]
        genes.node_used[:6], genes.node_id[:6] = True, np.arange(6)
        genes.activation[3:6] = [names["sin"], names["tanh"], names["gaussian"]]
        count = len(links)
        genes.connection_used[:count] = genes.enabled[:count] = True
        genes.innovation[:count] = np.arange(count)
        genes.source[:count], genes.target[:count] = np.transpose(links)
        random = np.random.default_rng(0)
        genes.weight[:count] = random.normal(size=count)
        genes.bias[3:6] = 0.3 * random.normal(size=3)
        return jax.tree.map(
            lambda x: jnp.asarray(x, dtype if x.dtype == np.float32 else None), genes
        )

    return cppn


@pytest.fixture
def loss(immerse, chain, network):
    """A function that makes, for a precision, what to differentiate and where."""

    def make(dtype, **form):
        body, cppn = chain(24), network(dtype)
        box, start = immerse(body, dtype, viscosity=VISCOSITY, size=SIZE, **form)
        controls = build_controls(
            Control(period=100, angle_scale=0.15, length_scale=0.05), body, STEPS
        )

        def travelled(inputs):
            weights, viscosity = inputs
            rest = genomes.develop(replace(cppn, weight=weights), controls)
            end, _ = world.rollout(replace(box, viscosity=viscosity), start, rest)
            return jnp.sum((jnp.mean(end.positions - start.positions, 0) - 0.3) ** 2)

        return travelled, (cppn.weight, box.viscosity)

    return make


def difference(value, inputs, along):
    """The slope along a direction by central differences."""
    ahead, behind = (jax.tree.map(lambda x, d, h=h: x + h * d, inputs, along) for h in (H, -H))
    return (value(ahead) - value(behind)) / (2 * H)


def test_gradients_of_200_coupled_steps_agree_with_finite_differences(loss, float64):
    travelled, inputs = loss(float64, limits=False)
    value = jax.jit(travelled)
    gradient = jax.jit(jax.grad(travelled))(inputs)
    random = np.random.default_rng(1)
    direction = jnp.asarray(random.normal(size=inputs[0].shape))
    for name, along in {
        "weights": (direction, jnp.zeros(())),
        "viscosity": (jnp.zeros_like(direction), jnp.asarray(0.1)),
    }.items():
        slope = sum(jnp.sum(g * d) for g, d in zip(gradient, along, strict=True))

        expected = difference(value, inputs, along)
        np.testing.assert_allclose(slope, expected, rtol=1e-6, err_msg=name)


@pytest.mark.parametrize("limits", [True, False])
def test_gradients_are_finite_in_float32(loss, limits):
    travelled, inputs = loss(jnp.dtype("float32"), limits=limits)
    for gradient in jax.jit(jax.grad(travelled))(inputs):
        assert gradient.dtype == jnp.float32
        assert np.all(np.isfinite(gradient))
        assert np.any(np.asarray(gradient) != 0)
