"""Gradients through network, development, body and fluid at once, limits acting or not.

`search/test_gradients.py` compares them with finite differences.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import genomes, world
from microcosmos.build import build_controls
from microcosmos.spec import Control

STEPS, SIZE, VISCOSITY = 200, (48, 48), 0.1


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


@pytest.mark.parametrize("limits", [True, False])
def test_gradients_are_finite_in_float32(loss, limits):
    travelled, inputs = loss(jnp.dtype("float32"), limits=limits)
    for gradient in jax.jit(jax.grad(travelled))(inputs):
        assert gradient.dtype == jnp.float32
        assert np.all(np.isfinite(gradient))
        assert np.any(np.asarray(gradient) != 0)
