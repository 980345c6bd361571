"""Creatures measured in several worlds, the energy elsewhere in each."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search, spec
from microcosmos.build import build_task

PLACE = {"width": 24, "height": 24, "energy": {"packets": 2, "width": 2.0, "placements": 3}}
ENERGY = search.MEASURES.index("energy")


@pytest.fixture(scope="module")
def task():
    scene = spec.Scene.model_validate(
        {
            "world": PLACE,
            "body": {"nodes": 8},
            "control": {"period": 20, "sense_energy": True, "angle_scale": 0.3},
            "task": {"steps": 20, "fitness": "displacement+energy", "energy_weight": 0.5},
        }
    )
    return build_task(scene, room=(12, 16))


@pytest.fixture(scope="module")
def network():
    return neat.minimal(jax.random.key(5), 4, 2, 12, 16)


def moved(task, shift):
    """The task in one world whose energy lies elsewhere."""
    energy = jnp.roll(task.start.energy, shift, (0, 1))
    return replace(task, start=replace(task.start, energy=energy), placements=None)


def test_what_is_measured_is_the_mean_over_all_placements(task, network):
    found = jax.jit(lambda: search.evaluate(task, network))()
    one = jax.jit(lambda shift: search.evaluate(moved(task, shift), network))
    each = [one(shift) for shift in task.placements]
    measures = np.mean([e.measures for e in each], 0)
    np.testing.assert_allclose(found.measures, measures, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(found.fitness, np.mean([e.fitness for e in each]), rtol=1e-5)
    assert np.ptp([e.measures[ENERGY] for e in each]) > 0.01


def test_the_first_placement_is_the_world_as_it_is_and_all_differ(task):
    assert not task.placements[0].any()
    assert len({tuple(shift.tolist()) for shift in task.placements}) == 3


def test_a_simulation_that_fails_in_one_world_fails(task, network):
    broken = replace(network, weight=network.weight.at[0].set(jnp.nan))
    assert jax.jit(lambda: search.evaluate(task, broken).status)() == 1


def test_gradients_are_of_the_mean(task, network, float64):
    task, network = jax.tree.map(
        lambda x: x.astype(float64) if jnp.issubdtype(x.dtype, jnp.floating) else x,
        (task, network),
    )
    values = search.gradients.parts(task, network, ("genes",))
    whole = jax.jit(lambda v: search.gradients.measures(task, network, v, ("energy",)))
    one = jax.jit(
        lambda v, shift: search.gradients.measures(moved(task, shift), network, v, ("energy",))
    )
    each = [one(values, shift)[0] for shift in task.placements]
    np.testing.assert_allclose(whole(values)[0], np.mean(each), rtol=1e-10)


def test_a_task_of_one_placement_has_no_axis_of_placements():
    assert build_task(spec.Scene(world=spec.World(energy=spec.Energy()))).placements is None
