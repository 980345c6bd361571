"""Means decide which offspring enter, in a hand-made noisy task.

A genotype's first three numbers are its true fitness, its true place on the first axis, and the
amplitude of the noise on both; a first evaluation adds luck.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from pydantic import ValidationError

from microcosmos import search
from microcosmos.build.experiments import build_plan
from microcosmos.device import array
from microcosmos.experiments import deciding
from microcosmos.experiments.state import start
from microcosmos.genomes import Vector
from microcosmos.search import Stopped
from microcosmos.spec import Reevaluation, parse

pytestmark = pytest.mark.long

HERE = search.LocalDevices()
DECIDES = {"decides": True, "samples": 4, "max_samples": 12, "max_error": 0.02}
INFEASIBLE = 99.0
"""Amplitude of creatures whose second sample is infeasible."""


@pytest.fixture(scope="module")
def plan(specs):
    document = specs["cma-mae"]
    search = document["search"] | {"reevaluation": DECIDES, "feasible": False}
    return build_plan(parse(document | {"search": search}))


def measured(plan, fitness, place):
    """Return evaluations at places from 0 to 1 on the first axis."""
    first, second = plan.axes
    measures = np.zeros((len(fitness), len(plan.measures)), np.float32)
    measures[:, first.measure] = first.value(array(place, np.float32))
    measures[:, second.measure] = second.value(jnp.zeros(1))
    status = array(np.zeros(len(fitness)), np.int32)
    return search.Evaluation(array(fitness, np.float32), array(measures), status)


def creatures(plan, rows):
    """Return genotypes of (fitness, place, amplitude)."""
    values = np.zeros((len(rows), *plan.genotype.values.shape), np.float32)
    values[:, :3] = rows
    return Vector(array(values))


@pytest.fixture(scope="module")
def programs(plan):
    again = plan.reevaluation

    def evaluate_block(given):
        genotypes, changed = jax.device_get(given)
        fitness, place, amplitude = genotypes.values[:, :3].T
        wave = np.cos(changed.phase)
        found = measured(plan, fitness + amplitude * wave, place + 0.1 * amplitude * wave)
        failed = (amplitude == INFEASIBLE) & (changed.phase > np.pi)
        return replace(found, status=array(failed, np.int32))

    return deciding.Programs(
        disturb=jax.jit(lambda *given: deciding.disturb(again, plan.key, *given)),
        evaluate_block=evaluate_block,
        cells_of=cells_of,
    )


@jax.jit
def cells_of(cells, measures):
    return cells.of(measures)


@jax.jit
def inserted(elites, container, number, genotypes, mean):
    """The elites after a generation whose means decide."""
    given = genotypes, mean.fitness, mean.measures, mean.status == 0
    return search.insert(elites, search.candidates(number, *given), container)[0]


@pytest.fixture
def generation(plan, programs):
    """A function from a state, creatures and their luck to the next state and what competed."""

    def next_state(state, rows, luck, decides=True):
        rows, genotypes = np.asarray(rows, np.float32), creatures(plan, rows)
        first = measured(plan, rows[:, 0] + luck, rows[:, 1])
        decided = deciding.undecided(first)
        if decides:
            arguments = (plan, programs, HERE, state, genotypes, first, search.never)
            decided = deciding.decide(*arguments)
        number = state.generation + 1
        given = number, genotypes, jax.tree.map(np.asarray, decided.mean)
        elites = inserted(state.elites, state.container, *given)
        return replace(state, generation=number, elites=elites), decided

    return next_state


def true_fitness(state):
    occupied = np.asarray(state.elites.occupied)
    return np.asarray(state.elites.genotypes.values)[occupied, 0].tolist()


def test_a_lucky_creature_does_not_replace_a_better_one(plan, generation):
    before, _ = generation(start(plan), [(2.0, 0.5, 0.0)], luck=np.zeros(1))
    lucky, luck = [(1.0, 0.5, 0.2)], np.array([9.0])
    assert true_fitness(generation(before, lucky, luck, decides=False)[0]) == [1.0]
    after, decided = generation(before, lucky, luck)
    assert true_fitness(after) == [2.0]
    assert decided.count.tolist() == [1], "its mean no longer enters after one sample"


def test_a_lucky_elite_gives_way_to_a_better_mean(plan, generation):
    """Where means do not decide, it never would."""
    better, plain = [(2.0, 0.5, 0.0)], {"decides": False}
    for options, kept in (({}, 2.0), (plain, 1.0)):
        state, _ = generation(start(plan), [(1.0, 0.5, 0.0)], np.array([9.0]), **options)
        state, _ = generation(state, better, np.zeros(1), **options)
        assert true_fitness(state) == [kept]


def test_only_offspring_that_would_enter_are_evaluated_again(plan, generation):
    before, _ = generation(start(plan), [(2.0, 0.5, 0.0)], luck=np.zeros(1))
    rows = [(1.0, 0.5, 0.0), (2.5, 0.5, 0.0), (1.0, 0.1, 0.0)]
    _, decided = generation(before, rows, np.zeros(3))
    assert decided.count.tolist() == [0, 4, 4]
    assert decided.simulated == 3 + 8


@pytest.mark.parametrize("amplitude", [0.01, 0.1, 0.5])
def test_samples_stop_once_the_mean_is_known(amplitude, plan, programs, generation):
    rows = [(1.0, 0.5, amplitude), (0.0, 0.1, 0.0)]
    _, decided = generation(start(plan), rows, np.zeros(2))
    count = decided.count[0]
    given = creatures(plan, rows)
    phases = [programs.disturb(given, jnp.asarray(s)).phase[0] for s in range(count)]
    noise = amplitude * np.cos(phases)
    np.testing.assert_allclose(decided.mean.fitness[0], 1 + noise.mean(), rtol=1e-5)
    errors = [noise[:n].std(ddof=1) / np.sqrt(n) for n in range(4, count + 1)]
    assert all(error > 0.02 for error in errors[:-1]), "the range of fitness is 1"
    assert errors[-1] <= 0.02 or count == 12
    assert decided.count[1] == 4, "without noise the fewest suffice"


def test_creatures_compete_in_the_cells_of_their_means(plan, generation):
    rows = [(fitness, 0.5, 2.0) for fitness in (1.0, 1.5, 2.0, 2.5)]
    state, decided = generation(start(plan), rows, np.zeros(4))
    first, mean = (
        set(np.asarray(cells_of(state.container, np.asarray(one.measures))).tolist())
        for one in (decided.first, decided.mean)
    )
    assert set(np.flatnonzero(state.elites.occupied).tolist()) == mean
    assert len(first) == 1 < len(mean)


def test_a_creature_that_is_infeasible_in_a_sample_is_infeasible(plan, generation):
    state, decided = generation(start(plan), [(1.0, 0.5, INFEASIBLE)], np.zeros(1))
    assert decided.mean.status.tolist() == [1]
    assert not np.asarray(state.elites.occupied).any()
    assert decided.first.status.tolist() == [0]


def test_means_do_not_depend_on_order_or_generation(plan, generation):
    random = np.random.default_rng(1)
    rows = np.column_stack(random.uniform(0, 1, (3, 12))).astype(np.float32)
    luck, order = random.uniform(0, 1, 12), random.permutation(12)
    state, decided = generation(start(plan), rows, luck)
    later = replace(start(plan), generation=7)
    other, permuted = generation(later, rows[order], luck[order])
    np.testing.assert_array_equal(permuted.mean.fitness, decided.mean.fitness[order])
    np.testing.assert_array_equal(permuted.mean.measures, decided.mean.measures[order])
    np.testing.assert_array_equal(permuted.count, decided.count[order])
    for name in ("occupied", "fitness", "measures"):
        np.testing.assert_array_equal(getattr(other.elites, name), getattr(state.elites, name))


@pytest.mark.parametrize("seed", range(3))
def test_the_archive_holds_the_best_whatever_the_order_and_the_batches(seed, plan, generation):
    """Luck is positive, so every creature that is better is evaluated again."""
    random = np.random.default_rng(seed)
    rows = np.column_stack([random.uniform(0, 1, (2, 40)).T, np.zeros(40)]).astype(np.float32)
    luck = random.exponential(1.0, 40)
    archives = []
    for batch in (4, 20):
        state = start(plan)
        for part in np.split(random.permutation(40), 40 // batch):
            state, _ = generation(state, rows[part], luck[part])
        archives.append(state.elites)
    place = np.asarray(archives[0].measures)[:, plan.axes[0].measure]
    measures = measured(plan, rows[:, 0], rows[:, 1]).measures
    cells = np.asarray(cells_of(plan.container, measures))
    best = {cell: rows[cells == cell, 0].max() for cell in cells.tolist()}
    for elites in archives:
        found = np.asarray(elites.fitness)[list(best)]
        np.testing.assert_allclose(found, list(best.values()), rtol=1e-6)
        np.testing.assert_array_equal(elites.measures[:, plan.axes[0].measure], place)


def test_it_stops_between_blocks(plan, programs):
    rows = np.array([(1.0, 0.5, 0.0)], np.float32)
    first, state = measured(plan, rows[:, 0], rows[:, 1]), start(plan)
    with pytest.raises(Stopped):
        deciding.decide(plan, programs, HERE, state, creatures(plan, rows), first, lambda: True)


def test_a_run_records_the_mean_and_the_first_evaluation(course_of):
    states, reports, experiment, _ = course_of("deciding")
    state, last = states[-1], {e.cell: e for report in reports for e in report.elites}
    occupied = np.flatnonzero(state.elites.occupied)
    assert set(last) == set(occupied.tolist())
    for cell in occupied.tolist():
        measured = experiment.creature(state, cell)["measured"]
        assert measured == last[cell].measured
        assert measured["fitness"] == state.first.fitness[cell]
        assert last[cell].fitness == np.asarray(state.elites.fitness)[cell]
        assert measured["fitness"] != last[cell].fitness
    assert set(state.first.count[occupied].tolist()) <= {2, 3}
    offspring = 8 * len(reports)
    assert state.evaluations > offspring + state.first.count[occupied].sum()


def test_the_most_samples_are_at_least_the_fewest():
    with pytest.raises(
        ValidationError, match=r"`max_samples` must be at least `samples` \(20\)"
    ):
        Reevaluation(samples=20)
