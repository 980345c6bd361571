"""Derivatives of what is measured against finite differences, for every part of a creature."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import spec
from microcosmos.build import build_task
from microcosmos.search import gradients

STEPS = 200
OF = ("fitness", "path_length", "bending_effort", "stretching_effort", "power", "symmetry")
SIZES = (1e-3, 1e-4, 1e-5, 1e-6)
"""Steps of finite differences; the best counts: a path's length bends sharply near rest."""

CONTROLS = {
    "cppn": {
        "period": 50,
        "angle_scale": 0.1,
        "length_scale": 0.05,
        "lag": 4,
        "wave_number": 1,
    },
    "direct": {"encoding": "direct", "period": 50, "lag": 4},
}
KEYS = {"cppn": 4, "direct": 3}
"""Of creatures whose path does not turn sharply within the steps of finite differences."""


@pytest.fixture(params=["cppn", pytest.param("direct", marks=pytest.mark.long)])
def creature(request, float64):
    """A small swimmer of each encoding in double precision, no limit acting."""
    world = {"width": 24, "height": 24, "viscosity": 0.1}
    parts = {"world": world, "body": {"nodes": 8}, "coupling": {"limits": False}}
    parts |= {"control": CONTROLS[request.param], "task": {"steps": STEPS}}
    scene = spec.Scene.model_validate(parts)
    task = build_task(scene, float64, room=(8, 12))
    newcomer = task.encoding.newcomer(key=jax.random.key(KEYS[request.param]))
    double = partial(jax.tree.map, lambda x: x.astype(float64) if x.dtype == "f" else x)
    return task, double(newcomer)


@pytest.mark.long
def test_derivatives_by_every_part_are_those_of_finite_differences(creature):
    task, genotype = creature
    values = gradients.parts(task, genotype)
    value = jax.jit(lambda v: gradients.measures(task, genotype, v, OF))
    backward = partial(gradients.value_and_jacobian, task, genotype, of=OF, segment=15)
    found, rows = jax.jit(backward)(values)
    np.testing.assert_allclose(found, value(values), rtol=1e-10)
    random = np.random.default_rng(1)
    for name, at in values.items():
        along = jnp.asarray(random.normal(size=at.shape))
        slope = np.asarray(jnp.tensordot(rows[name], along, along.ndim))
        scale = np.maximum(np.abs(slope), 1e-4)
        errors = []
        for h in SIZES:
            ahead, behind = (value(values | {name: at + d * along}) for d in (h, -h))
            errors.append(np.abs(slope - (ahead - behind) / (2 * h)) / scale)
        error = np.min(errors, axis=0)
        assert error.max() <= 1e-6, f"{name}: {dict(zip(OF, error.tolist(), strict=True))}"
        if name not in ("bend", "shear", "stretch"):
            assert np.abs(slope[0]) > 1e-6, name


@pytest.mark.long
def test_measures_and_genes_without_derivatives_are_refused():
    task = build_task(spec.Scene())
    genotype = task.encoding.newcomer(key=jax.random.key(0))
    with pytest.raises(ValueError, match=r"`by` must be of .*, got colour"):
        gradients.parts(task, genotype, ("colour",))
    with pytest.raises(ValueError, match=r"`of` must be of .*, got hidden_nodes"):
        gradients.measures(task, genotype, {}, ("hidden_nodes",))
