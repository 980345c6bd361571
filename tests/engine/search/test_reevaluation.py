"""Repeated, disturbed and displaced evaluations."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search, spec
from microcosmos.build import build_task
from microcosmos.genomes import Vector
from microcosmos.search import disturbance
from microcosmos.search.disturbance import Disturbance
from microcosmos.search.evaluation import FEASIBLE
from microcosmos.search.parts import reevaluation
from microcosmos.spec import Chain, Control, Energy, Scene, Task, World

CONTROL = {"period": 20, "wave_number": None, "sense_energy": True, "angle_scale": 0.3}
STILL = {"phase": 0.0, "turn": 0.0, "shift": (0.0, 0.0), "viscosity": 1.0, "energy": (0, 0)}


@pytest.fixture(scope="module")
def task():
    scene = Scene(
        world=World(width=24, height=24, energy=Energy(packets=2)),
        body=Chain(nodes=8),
        control=Control(**CONTROL, ramp=0.0),
        task=Task(steps=40),
    )
    return build_task(scene, room=(12, 16))


@pytest.fixture(scope="module")
def sensing():
    return neat.minimal(jax.random.key(5), 4, 2, 12, 16)


@pytest.fixture(scope="module")
def network(sensing):
    # Energy has no weight: elsewhere it must not change the motion.
    return replace(sensing, weight=jnp.where(sensing.source == 3, 0.0, sensing.weight))


@pytest.fixture(scope="module")
def disturbed(task, network):
    """A function from what is disturbed to the measures by name."""
    run = jax.jit(lambda changed: disturbance.evaluate_disturbed(task, network, changed))

    def found(**changes):
        values = (STILL | changes).items()
        types = {"energy": jnp.int32}
        whole = {n: jnp.asarray(value, types.get(n, jnp.float32)) for n, value in values}
        evaluation = run(Disturbance(**whole))
        assert evaluation.status == 0
        measures = np.asarray(evaluation.measures)
        return dict(zip(search.MEASURES, measures.tolist(), strict=True))

    return found


def measured(task, network):
    measures = jax.jit(lambda: search.evaluate(task, network).measures)()
    return dict(zip(search.MEASURES, np.asarray(measures).tolist(), strict=True))


@pytest.fixture(scope="module")
def plain(task, network):
    return measured(task, network)


def test_a_disturbance_is_of_every_trial(task, network):
    task = replace(task, trials=3)
    still = {n: jnp.asarray(v, jnp.int32 if n == "energy" else None) for n, v in STILL.items()}
    again = jax.jit(
        lambda: disturbance.evaluate_disturbed(task, network, Disturbance(**still))
    )()
    found = jax.jit(lambda: search.evaluate(task, network))()
    assert found.measures[search.MEASURES.index("trial_spread")] > 1e-3
    np.testing.assert_allclose(again.fitness, found.fitness, rtol=1e-4)
    np.testing.assert_allclose(again.measures, found.measures, rtol=1e-3, atol=1e-5)


MOTION = ("displacement", "path_length", "bending_effort", "rotation")


def agree(found, expected, names=MOTION, rel=1e-3):
    assert expected["displacement"] > 1e-3
    for name in names:
        assert found[name] == pytest.approx(expected[name], rel=rel, abs=1e-5), name


def test_the_lattice_is_the_same_everywhere_and_in_its_four_directions(disturbed, plain):
    agree(disturbed(), plain, (*MOTION, "energy", "mach"))
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
    agree(disturbed(viscosity=1.05), measured(other, network))


@pytest.mark.long
def test_trials_differ_in_heading_and_phase(disturbed, task, network):
    """Results are means over the trials; of what makes a creature infeasible, the largest."""
    several = replace(task, trials=3)
    found = measured(several, network)
    ones = [disturbed(phase=2 * np.pi * k / 3, turn=np.pi / 4 * k) for k in range(3)]
    fitness = [one["speed"] for one in ones]
    for name in ("speed", "path_length", "wave_number"):
        mean = np.mean([one[name] for one in ones])
        assert found[name] == pytest.approx(mean, rel=1e-3), name
    assert found["mach"] == pytest.approx(max(one["mach"] for one in ones), rel=1e-3)
    assert found["trial_spread"] == pytest.approx(np.std(fitness, ddof=1), rel=0.02)
    assert found["trial_spread"] > 0.01 * np.mean(fitness)
    whole = search.gradients.measures(several, network, {}, ("fitness", "path_length"))
    expected = found["speed"], found["path_length"]
    np.testing.assert_allclose(whole, expected, rtol=1e-3)


def test_disturbances_stay_within_the_spread():
    spread = disturbance.Spread(viscosity=0.05)
    keys = jax.random.split(jax.random.key(0), 4000)
    drawn = jax.vmap(lambda key: disturbance.disturbance(spread, (30, 20), key=key))(keys)
    assert 0.95 <= drawn.viscosity.min() < 0.951
    assert 1.049 < drawn.viscosity.max() <= 1.05
    assert (drawn.energy.max(0) == np.array([29, 19])).all()
    np.testing.assert_allclose(drawn.turn.mean(), np.pi, rtol=0.03)
    off = disturbance.Spread(phase=False, pose=False, viscosity=0.0, energy=False)
    none = disturbance.disturbance(off, (30, 20), key=keys[0])
    assert (none.phase, none.turn, none.viscosity) == (0, 0, 1)
    assert not none.shift.any()
    assert not none.energy.any()


CELLS = 4


@pytest.fixture
def found():
    def make(fitness, measure, status=(0, 0, 0, 0)):
        return search.Evaluation(
            jnp.asarray(fitness, jnp.float32),
            jnp.asarray(measure, jnp.float32)[:, None],
            jnp.asarray(status),
        )

    return make


def elites_at(*measures, occupied=(True, True, True, True)):
    """Elites of one measure each."""
    none = search.no_elites(CELLS, 1, Vector(jnp.zeros(1)))
    rows = jnp.asarray(measures, jnp.float32)[:, None]
    return replace(none, occupied=jnp.asarray(occupied), measures=rows)


HOMES = (0.1, 0.3, 0.6, 0.9)
"""A place in each of four cells."""


@pytest.fixture
def repeated(one_axis, found):
    """A function that adds evaluations, each given as `found` takes it, to no repeats."""
    add = jax.jit(reevaluation.add)

    def total(*evaluations, done=(True, True, True, True), homes=HOMES):
        repeats, elites = reevaluation.no_repeats(CELLS, 1), elites_at(*homes, occupied=done)
        for given in evaluations:
            repeats = add(repeats, elites, found(*given), one_axis(CELLS))
        return repeats

    return total


def test_means_and_spreads_are_those_of_all_samples(repeated):
    random = np.random.default_rng(0)
    samples = random.normal(2.0, 1.0, (20, CELLS)).astype(np.float32)
    repeats = repeated(*((row, row / 8) for row in samples), done=(True, True, True, False))
    assert repeats.count.tolist() == [20, 20, 20, 0]
    np.testing.assert_allclose(repeats.fitness[:3], samples.mean(0)[:3], rtol=1e-5)
    spread = np.sqrt(np.asarray(repeats.squares)[:3] / 19)
    np.testing.assert_allclose(spread, samples.std(0, ddof=1)[:3], rtol=1e-5)
    assert repeats.fitness[3] == 0


def test_infeasible_repeats_are_counted_and_in_no_mean(repeated):
    bad = [np.nan, np.inf, 3.0, 1.0], [np.nan, np.inf, 0.3, 0.1], (1, 1, 0, 0)
    repeats = repeated(([1.0, 1, 1, 1], [0.1] * 4), bad)
    assert repeats.failed.tolist() == [1, 1, 0, 0]
    np.testing.assert_allclose(repeats.fitness, [1, 1, 2, 1])
    np.testing.assert_allclose(repeats.measures[:, 0], [0.1, 0.1, 0.2, 0.1], rtol=1e-6)


def test_a_hit_is_a_repeat_in_the_elites_own_cell(repeated):
    measures = [0.1, 0.3, 0.6, 0.9], [0.1, 0.1, 0.6, 0.6]
    rows = [([1.0] * 4, row) for row in measures]
    assert repeated(*rows).hits.tolist() == [2, 1, 2, 1]
    assert repeated(*rows, homes=(0.1, 0.1, 0.9, 0.9)).hits.tolist() == [2, 1, 0, 1]


def test_a_new_elite_has_no_repeats_and_an_empty_place_has_none(repeated):
    repeats = repeated(([1.0, 2, 3, 4], [0.1] * 4))
    entered, occupied = jnp.asarray([True, False]), jnp.asarray([True, True, True, False])
    repeats = reevaluation.forget(repeats, jnp.asarray([2, 0]), entered, occupied)
    assert repeats.count.tolist() == [1, 1, 0, 0]
    assert repeats.fitness.tolist() == [1, 2, 0, 0]
    assert repeats.measures[:, 0].tolist() == [np.float32(0.1), np.float32(0.1), 0, 0]


def test_the_corrected_archive_holds_the_best_mean_of_each_cell(repeated, one_axis):
    # The elites of cells 0 and 1 belong in cell 2, where one of them is better.
    values = [5.0, 4.0, 1.0, 9.0], [0.6, 0.6, 0.6, 0.1]
    repeats = repeated(values, done=(True, True, True, False))
    corrected = reevaluation.corrected(elites_at(*HOMES), repeats, one_axis(CELLS))
    np.testing.assert_array_equal(corrected, [np.nan, np.nan, 5.0, np.nan])
    # Places need not be as many as bins.
    corrected = reevaluation.corrected(elites_at(*HOMES), repeats, one_axis(2))
    np.testing.assert_array_equal(corrected, [np.nan, 5.0])


PLACE = {"width": 24, "height": 24, "energy": {"packets": 2, "width": 2.0, "placements": 3}}
ENERGY = search.MEASURES.index("energy")


@pytest.fixture(scope="module")
def foraging():
    scene = spec.Scene.model_validate(
        {
            "world": PLACE,
            "body": {"nodes": 8},
            "control": CONTROL,
            "task": {"steps": 20, "fitness": "displacement+energy", "energy_weight": 0.5},
        }
    )
    return build_task(scene, room=(12, 16))


def moved(task, shift):
    energy = jnp.roll(task.start.energy, shift, (0, 1))
    return replace(task, start=replace(task.start, energy=energy), placements=None)


def test_measures_are_means_over_all_placements_and_the_largest_of_what_limits(
    foraging, sensing
):
    task, network = foraging, sensing
    found = jax.jit(lambda: search.evaluate(task, network))()
    one = jax.jit(lambda shift: search.evaluate(moved(task, shift), network))
    each = [one(shift) for shift in task.placements]
    rows = np.stack([e.measures for e in each])
    measures = rows.mean(0)
    deciding = [search.MEASURES.index(name) for name, _ in FEASIBLE.values()]
    measures[deciding] = rows[:, deciding].max(0)
    assert np.ptp(rows[:, search.MEASURES.index("mach")]) > 0
    np.testing.assert_allclose(found.measures, measures, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(found.fitness, np.mean([e.fitness for e in each]), rtol=1e-5)
    assert np.ptp([e.measures[ENERGY] for e in each]) > 0.01


@pytest.mark.long
def test_gradients_are_of_the_mean(foraging, sensing, float64):
    task, network = jax.tree.map(
        lambda x: x.astype(float64) if jnp.issubdtype(x.dtype, jnp.floating) else x,
        (foraging, sensing),
    )
    values = search.gradients.parts(task, network, ("genes",))
    measures, of = search.gradients.measures, ("energy",)
    one = jax.jit(lambda v, shift: measures(moved(task, shift), network, v, of))
    each = [one(values, shift)[0] for shift in task.placements]
    whole = jax.jit(lambda v: measures(task, network, v, of))(values)[0]
    np.testing.assert_allclose(whole, np.mean(each), rtol=1e-10)
