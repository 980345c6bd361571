"""Evaluation as a batch, as on a GPU, agrees with one creature at a time, as on a CPU."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import spec_cases
from genotypes import any_genotype

from microcosmos import filaments, plugins, search, spec, world
from microcosmos.build import build_stroke, build_task
from microcosmos.plugins import registry

COUNT = 3
"""Creatures of a block."""
UNUSED = {
    "PluginVersion.emits": "no emitter is part of a scene",
    "PluginVersion.settings": "a plug-in without settings runs alike",
    "Scene.measures": "these measures are computed from the motion",
    "Scene.plugins": "these measures are computed as that of a fitness is",
}
"""Fields without a case, and why."""
MOVERS = Path(spec_cases.__file__).with_name("movers.py")


@pytest.fixture(autouse=True)
def movers(monkeypatch):
    monkeypatch.setattr(registry, "_plugins", {})
    plugins.load(MOVERS)


def scene_of(name):
    return spec.Scene.model_validate(spec_cases.CASES[name])


def cases(kept=lambda document: True):
    """Return test parameters of the cases whose document is kept."""
    return [
        pytest.param(name, marks=() if name in spec_cases.QUICK else pytest.mark.long)
        for name, document in spec_cases.CASES.items()
        if kept(document)
    ]


def block_of(scene, encoding):
    """Draw the genotypes of a block."""
    rng = np.random.default_rng(0)
    return stacked([any_genotype(scene, encoding, rng) for _ in range(COUNT)])


def stroke_of(scene, dtype):
    """Return the function from conditions to the evaluation of a gait, and a block of them."""
    steps, period = scene.task.steps, scene.control.period
    task = build_task(scene, dtype)
    rest = build_stroke(scene.control, steps, dtype)
    drawn = [
        search.Conditions(viscosity, world.Limits(displacement, force))
        for viscosity, displacement, force in jnp.asarray(
            [[0.5, 0.1, 0.1], [0.05, 0.05, 0.03], [0.2, 0.1, 0.01]], dtype
        )
    ]
    return partial(search.swim, task, rest, period=period), stacked(drawn)


def stacked(parts):
    return jax.tree.map(lambda *rows: jnp.stack(rows), *parts)


def agree(function, block, monkeypatch):
    """Compare the program of a CPU with that of a GPU; return the block's results."""
    one = search.block_program(function)(block)
    monkeypatch.setattr(jax, "default_backend", lambda: "gpu")
    batch = search.block_program(function)(block)
    monkeypatch.undo()
    near = partial(np.testing.assert_allclose, rtol=1e-7, atol=1e-9)
    jax.tree.map(near, *(headed(found) for found in (batch, one)))
    return batch


def headed(found):
    """Return evaluations without the direction of a path where there is no path."""
    if len(found.measures[0]) < len(search.MEASURES):
        return found
    moved = found.measures[:, search.MEASURES.index("path_length")] > 1e-6
    of_path = [search.MEASURES.index(name) for name in ("straightness", "heading_angle")]
    kept = jnp.where(moved[:, None], found.measures[:, jnp.asarray(of_path)], 0.0)
    return replace(found, measures=found.measures.at[:, jnp.asarray(of_path)].set(kept))


@pytest.mark.parametrize("name", cases())
def test_a_batch_measures_what_one_creature_at_a_time_does(name, float64, monkeypatch):
    scene = scene_of(name)
    if isinstance(scene.control, spec.Gait):
        function, block = stroke_of(scene, float64)
    else:
        task = build_task(scene, float64)
        function, block = partial(search.evaluate, task), block_of(scene, task.encoding)
    found = agree(function, block, monkeypatch)
    assert np.all(found.status == 0)
    assert len({row.tobytes() for row in np.asarray(found.measures)}) == COUNT


@pytest.mark.long
@pytest.mark.parametrize("name", ["a network", "a network that senses"])
def test_a_batch_of_disturbed_creatures_measures_what_each_alone_does(
    name, float64, monkeypatch
):
    scene = scene_of(name)
    task = build_task(scene, float64)
    spread, size = search.disturbance.Spread(), task.world.size
    keys = jax.random.split(jax.random.key(0), COUNT)
    changes = jax.vmap(lambda key: search.disturbance.disturbance(spread, size, key=key))(keys)
    changes = jax.tree.map(lambda x: x.astype(float64) if x.dtype.kind == "f" else x, changes)
    agree(
        lambda given: search.disturbance.evaluate_disturbed(task, *given),
        (block_of(scene, task.encoding), changes),
        monkeypatch,
    )


def native_case(name):
    """Return whether the native kernel simulates a case."""
    return spec_cases.CASES[name]["control"].get("encoding") != "fold"


def carried_out(box, start, given):
    """Return all that the native kernel finds."""
    if isinstance(given, world.Controller) and not given.senses:
        rest, clock = world.native.develop(box, start, given)
        return rest, clock, world.native.rollout(box, start, rest)
    return world.native.rollout(box, start, given)


@pytest.mark.parametrize("name", [case for case in cases() if native_case(case.values[0])])
def test_the_kernel_gives_a_batch_the_bits_of_each_creature(name):
    pytest.importorskip(
        "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
    )
    operands = operands_of(scene_of(name))
    one = jax.jit(lambda given: jax.lax.map(lambda row: carried_out(*row), given))(operands)
    # What is the same for all creatures has no axis of the batch, as in an evaluation.
    shared = jax.tree.map(lambda x: None if np.all(x == x[:1]) else 0, operands)
    given = jax.tree.map(lambda x, axis: x if axis == 0 else x[0], operands, shared)
    batch = jax.jit(jax.vmap(carried_out, in_axes=shared))(*given)
    jax.tree.map(np.testing.assert_array_equal, batch, one)
    assert all(np.all(np.isfinite(x)) for x in jax.tree.leaves(one))


def operands_of(scene):
    """Return worlds, starts and controllers of a block, each turned and delayed otherwise."""
    task = build_task(scene)
    if isinstance(scene.control, spec.Gait):
        rest = build_stroke(scene.control, scene.task.steps)
        sizes = jnp.linspace(0.9, 1.1, COUNT)[:, None, None]
        rests = filaments.Rest(sizes * rest.angle[None], sizes * rest.length[None])
        alike = jax.tree.map(lambda x: jnp.stack([x] * COUNT), (task.world, task.start))
        return *alike, rests

    def driven(given):
        genotype, phase = given
        begun = replace(task, phase=phase, turn=phase)
        found = search.drive(begun, genotype, differentiable=True)
        return found.world, found.start, found.controller or found.inputs

    phases = jnp.linspace(0, 1, COUNT)
    return jax.jit(lambda given: jax.lax.map(driven, given))(
        (block_of(scene, task.encoding), phases)
    )


@pytest.mark.fast
def test_every_encoding_and_field_of_a_scene_has_a_case():
    scenes = [scene_of(name) for name in spec_cases.CASES]
    assert not spec_cases.lacking_in(scenes, UNUSED)
