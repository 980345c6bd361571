"""A search that predicts its offspring, beside one that simulates all of them."""

import json

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import neat, search
from microcosmos.archive import file
from microcosmos.build import build
from microcosmos.experiments import screening
from microcosmos.experiments.offspring import divided
from microcosmos.experiments.state import PREDICTIONS
from microcosmos.search.screening import READY
from microcosmos.spec import parse

pytestmark = pytest.mark.long

EXPERIMENT = "screened"
FIRST = READY // 16
"""Generations before the first prediction."""


@pytest.fixture(scope="module")
def pool(course):
    """The candidates of the last generation."""
    plan, programs = course.experiment.plan, course.experiment.programs
    state = course.states[-2]
    inserts = programs.insert, programs.overwrite
    given = inserts, state, divided(plan, state), search.never
    return screening.candidates(plan, programs.screen, *given)


def test_predictions_are_recorded_from_the_first_screened_generation_on(course):
    tree, _ = file.load(course.experiment.save(course.states[-1]))
    assert set(tree["screening"]) == set(PREDICTIONS)
    error = tree["screening"]["fitness_error"]
    assert np.isnan(error[:FIRST]).all()
    assert np.isfinite(error[FIRST:]).all()
    assert 0 <= tree["screening"]["cell_hits"][-1] <= 1
    summary = course.reports[-1].summary
    assert summary["predicted: fitness_error"] == pytest.approx(error[-1])
    assert "predicted: fitness_error" not in course.reports[0].summary


def test_until_it_is_ready_it_is_the_search_without_screening(course, specs):
    document = json.loads(json.dumps(specs["screened"]))
    del document["search"]["screening"]
    plain = build(parse(document))
    state = plain.init()
    for expected in course.states[1 : FIRST + 1]:
        state, _ = plain.advance(state)
        jax.tree.map(np.testing.assert_array_equal, state.elites, expected.elites)


def test_only_simulations_count_as_evaluations(course):
    assert [state.evaluations for state in course.states] == list(range(0, 16 * 12, 16))


def test_every_emitter_fills_its_slots_with_its_own_candidates(course, pool):
    plan, programs = course.experiment.plan, course.experiment.programs
    found, counters = pool
    assert len(found.emitter) == 2 * 3 * 16
    state = course.states[-2]
    given = state, found, counters, divided(plan, state)
    children, _ = screening.chosen(plan, programs.screen, *given)
    operators = [search.OPERATORS[code] for code in children.operator]
    assert set(operators[:12]) <= {"neat", "crossover"}
    assert set(operators[12:]) == {"random"}


def test_parents_of_candidates_are_elites_that_were_simulated(course, pool):
    """Or none, where they descend from a predicted newcomer."""
    found, _ = pool
    parents = np.asarray(found.children.parents)
    occupied = np.asarray(course.states[-2].elites.occupied)
    varied = parents[found.emitter == 0, 0]
    assert occupied[varied[varied >= 0]].all()
    assert np.mean(varied >= 0) > 0.5
    assert (parents[found.emitter == 1] == search.NO_PARENT).all()


def test_candidates_of_later_rounds_descend_from_predicted_ones(course, pool):
    """Some have genes that two mutations made."""
    found, _ = pool
    genotypes, count = found.children.genotypes, len(found.emitter) // 2
    first, elites = course.states[-2].counters, course.states[-2].elites
    used = np.asarray(genotypes.connection_used)
    new = (np.asarray(genotypes.innovation) >= int(first.innovation)) & used
    assert new[count:].any()
    assert np.asarray(elites.genotypes.innovation).max() < int(first.innovation)
    made = {int(number) for number in np.asarray(genotypes.innovation)[:count][new[:count]]}
    inherited = np.isin(np.asarray(genotypes.innovation)[count:], sorted(made))
    assert (inherited & used[count:]).any()


def test_numbers_of_genes_have_no_gaps_after_the_choice(course):
    before, after = course.states[-2], course.states[-1]
    plan, programs = course.experiment.plan, course.experiment.programs
    emitter = divided(plan, before)
    inserts = programs.insert, programs.overwrite
    found, counters = screening.candidates(
        plan, programs.screen, inserts, before, emitter, search.never
    )
    children, kept = screening.chosen(plan, programs.screen, before, found, counters, emitter)
    network = children.genotypes
    numbers = np.asarray(network.innovation)[np.asarray(network.connection_used)]
    new = np.unique(numbers[numbers >= int(before.counters.innovation)])
    wanted = np.arange(int(before.counters.innovation), int(kept.innovation))
    np.testing.assert_array_equal(new, wanted)
    assert int(after.counters.innovation) == int(kept.innovation)
    assert int(kept.innovation) < int(counters.innovation)


def test_compacted_numbers_keep_their_order_and_equality(course):
    network = jax.device_get(course.states[-1].elites.genotypes)
    rows = jax.tree.map(lambda x: x[np.asarray(course.states[-1].elites.occupied)], network)
    first = neat.Counters(*(jnp.asarray(n) for n in (12, 8, 3)))
    numbers = (
        np.where(rows.innovation >= 12, 3 * rows.innovation, rows.innovation),
        np.where(rows.node_id >= 8, 5 * rows.node_id, rows.node_id),
    )
    apart = eqx.tree_at(lambda one: (one.innovation, one.node_id), rows, numbers)
    one, other = (neat.compacted(each, first) for each in (rows, apart))
    jax.tree.map(np.testing.assert_array_equal, one, other)
    old, new = rows.innovation[rows.connection_used], one[0].innovation[rows.connection_used]
    np.testing.assert_array_equal(np.argsort(old, stable=True), np.argsort(new, stable=True))
    assert len(np.unique(old)) == len(np.unique(new))


@pytest.mark.parametrize(
    ("part", "message"),
    [
        (
            {"control": {"timer": "linear"}, "task": {"fitness": "displacement"}},
            "`control.timer` must be 'sine-cosine'",
        ),
        ({"control": {"recurrent": True}}, "`control.recurrent` must be false"),
        (
            {
                "control": {"encoding": "direct"},
                "search": {"screening": {}, "emitters": [{"operator": "cma-mae"}]},
            },
            "`emitters` must be among random, neat, iso\\+line, gaussian",
        ),
    ],
)
def test_what_cannot_be_screened_is_refused(part, message):
    document = {"experiment": "quality-diversity", "search": {"screening": {}}}
    with pytest.raises(ValueError, match=message):
        parse(document | part)
