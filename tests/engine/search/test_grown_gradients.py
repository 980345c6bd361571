"""Derivatives through growth, against finite differences."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from grown_bodies import ROOM, genotype_of, grown_scene

from microcosmos.build import build_task
from microcosmos.search import gradients

SIZES = (1e-4, 1e-5, 1e-6)
"""Steps of finite differences; the best counts."""


@pytest.fixture
def creature(float64):
    """A branched body with a ring and soft joints, in double precision, no limit acting."""
    scene = grown_scene(softest=0.3, steric=False, steps=12)
    coupling = scene.coupling.model_copy(update={"limits": False})
    scene = scene.model_copy(update={"coupling": coupling})
    task = build_task(scene, float64, room=ROOM)

    def double(x):
        return jnp.asarray(x, float64 if x.dtype == "f" else None)

    return task, jax.tree.map(double, genotype_of(scene))


@pytest.mark.long
def test_derivatives_by_a_plan_a_network_and_rest_shapes_are_those_of_differences(creature):
    task, genotype = creature
    values = gradients.parts(task, genotype)
    value = jax.jit(lambda v: gradients.measures(task, genotype, v))
    backward = partial(gradients.value_and_jacobian, task, genotype, segment=5)
    found, rows = jax.jit(backward)(values)
    np.testing.assert_allclose(found, value(values), rtol=1e-8)
    random = np.random.default_rng(0)
    for name, at in values.items():
        along = jnp.asarray(random.normal(size=at.shape))
        slope = float(jnp.tensordot(rows[name][0], along, along.ndim))
        assert abs(slope) > 1e-6, name
        errors = []
        for h in SIZES:
            ahead, behind = (value(values | {name: at + d * along})[0] for d in (h, -h))
            errors.append(abs(slope - (ahead - behind) / (2 * h)) / abs(slope))
        assert min(errors) <= 1e-6, f"{name}: {errors}"


def test_a_plan_has_genes_of_segments_in_place_of_stiffnesses(creature):
    task, genotype = creature
    found = gradients.parts(task, genotype)
    assert found["segment_curl"].shape == genotype.plan.curl.shape
    assert "genes" in found
    with pytest.raises(ValueError, match=r"`by` must be of .*segment_angle.*, got bend"):
        gradients.parts(task, genotype, ("bend",))
