"""Disturbed conditions are the world's symmetries, or what they say; repeats add up."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.build import build_task
from microcosmos.search import reevaluation
from microcosmos.search.reevaluation import Disturbance
from microcosmos.spec import Chain, Control, Energy, Scene, Task, World

STILL = {"phase": 0.0, "turn": 0.0, "shift": (0.0, 0.0), "viscosity": 1.0, "energy": (0, 0)}


@pytest.fixture(scope="module")
def task():
    scene = Scene(
        world=World(width=24, height=24, energy=Energy(packets=2)),
        body=Chain(nodes=8),
        control=Control(period=20, ramp=0.0, sense_energy=True, angle_scale=0.3),
        task=Task(steps=40),
    )
    return build_task(scene, room=(12, 16))


@pytest.fixture(scope="module")
def network():
    made = neat.minimal(jax.random.key(5), 4, 2, 12, 16)
    # Energy has no weight: elsewhere it must not change the motion.
    return replace(made, weight=jnp.where(made.source == 3, 0.0, made.weight))


@pytest.fixture(scope="module")
def disturbed(task, network):
    """A function from what is disturbed to the measures by name."""
    run = jax.jit(lambda changed: reevaluation.evaluate_disturbed(task, network, changed))

    def found(**changes):
        values = {**STILL, **changes}
        whole = {
            name: jnp.asarray(value, jnp.int32 if name == "energy" else jnp.float32)
            for name, value in values.items()
        }
        evaluation = run(Disturbance(**whole))
        assert evaluation.status == 0
        measures = np.asarray(evaluation.measures)
        return dict(zip(search.MEASURES, measures.tolist(), strict=True))

    return found


@pytest.fixture(scope="module")
def plain(task, network):
    measures = jax.jit(lambda: search.evaluate(task, network).measures)()
    return dict(zip(search.MEASURES, np.asarray(measures).tolist(), strict=True))


MOTION = ("displacement", "path_length", "bending_effort", "rotation")


def agree(found, expected, names=MOTION, rel=1e-3):
    assert expected["displacement"] > 1e-3
    for name in names:
        assert found[name] == pytest.approx(expected[name], rel=rel, abs=1e-5), name


def test_conditions_that_are_not_disturbed_change_nothing(disturbed, plain):
    agree(disturbed(), plain, (*MOTION, "energy", "mach"))


def test_the_lattice_is_the_same_everywhere_and_in_its_four_directions(disturbed, plain):
    agree(disturbed(shift=(7.0, -3.0)), plain)
    agree(disturbed(turn=np.pi / 2), plain)
    agree(disturbed(turn=np.pi, shift=(1.0, 2.0)), plain)


def test_energy_is_moved_with_a_body_that_is_moved(disturbed, plain):
    found = disturbed(shift=(5.0, 2.0), energy=(5, 2))
    agree(found, plain, (*MOTION, "energy"))
    assert disturbed(energy=(5, 2))["energy"] != pytest.approx(plain["energy"], rel=1e-2)


def test_a_whole_period_ahead_is_no_change_and_half_a_period_is_one(disturbed, plain):
    agree(disturbed(phase=2 * np.pi), plain)
    later = disturbed(phase=np.pi)
    assert later["displacement"] != pytest.approx(plain["displacement"], rel=1e-2)


def test_a_factor_of_viscosity_is_that_viscosity(disturbed, task, network):
    other = replace(task, world=replace(task.world, viscosity=1.05 * task.world.viscosity))
    measures = jax.jit(lambda: search.evaluate(other, network).measures)()
    expected = dict(zip(search.MEASURES, np.asarray(measures).tolist(), strict=True))
    agree(disturbed(viscosity=1.05), expected)


def test_what_is_drawn_stays_within_the_spread():
    spread = reevaluation.Spread(viscosity=0.05)
    keys = jax.random.split(jax.random.key(0), 4000)
    drawn = jax.vmap(lambda key: reevaluation.disturbance(spread, (30, 20), key=key))(keys)
    assert 0.95 <= drawn.viscosity.min() < 0.951
    assert 1.049 < drawn.viscosity.max() <= 1.05
    assert (drawn.energy.max(0) == np.array([29, 19])).all()
    np.testing.assert_allclose(drawn.turn.mean(), np.pi, rtol=0.03)
    off = reevaluation.Spread(phase=False, pose=False, viscosity=0.0, energy=False)
    none = reevaluation.disturbance(off, (30, 20), key=keys[0])
    assert (none.phase, none.turn, none.viscosity) == (0, 0, 1)
    assert not none.shift.any()
    assert not none.energy.any()
