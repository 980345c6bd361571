"""A search that predicts its offspring, beside one that simulates all of them."""

import json

import jax
import numpy as np
import pytest

from microcosmos import search
from microcosmos.archive import file
from microcosmos.build import build
from microcosmos.search import loop
from microcosmos.search.parts.screening import DESCRIBE, PREDICTIONS
from microcosmos.search.screening import READY
from microcosmos.spec import parse

pytestmark = pytest.mark.long

EXPERIMENT = "screened"
FIRST = READY // 16
"""Generations before the first prediction."""


@pytest.fixture(scope="module")
def screened(course):
    """The candidates of each round of the last generation, and the children chosen of them."""
    plan, rounds = course.experiment.plan, []

    def answer(ask):
        assert ask.program == DESCRIBE
        rounds.append(ask.rows)
        return search.evaluate_blocks(plan.programs[DESCRIBE].run, ask.rows, block=plan.batch)

    return rounds, loop.drive(loop.proposed(plan, course.states[-2]), answer).batch


def test_predictions_are_recorded_from_the_first_screened_generation_on(course):
    tree, _ = file.load(course.experiment.save(course.states[-1]))
    assert set(tree["screening"]) == set(PREDICTIONS)
    error = tree["screening"]["fitness_error"]
    assert np.isnan(error[:FIRST]).all()
    assert np.isfinite(error[FIRST:]).all()
    assert 0 <= tree["screening"]["cell_hits"][-1] <= 1
    summary = course.reports[-1].summary
    assert summary["predicted.fitness_error"] == pytest.approx(error[-1])
    assert "predicted.fitness_error" not in course.reports[0].summary


def test_until_it_is_ready_it_is_the_search_without_screening(course, specs):
    document = json.loads(json.dumps(specs["screened"]))
    del document["search"]["screening"]
    plain = build(parse(document))
    state = plain.init()
    for expected in course.states[1 : FIRST + 1]:
        state, _ = plain.advance(state)
        jax.tree.map(np.testing.assert_array_equal, state.elites, expected.elites)


def test_every_emitter_fills_its_slots_with_its_own_candidates(screened):
    rounds, batch = screened
    assert [len(jax.tree.leaves(rows)[0]) for rows in rounds] == [3 * 16, 3 * 16]
    operators = [search.OPERATORS[code] for code in batch.children.operator]
    assert set(operators[:12]) <= {"neat", "crossover"}
    assert set(operators[12:]) == {"random"}


def test_numbers_of_genes_have_no_gaps_after_the_choice(course, screened):
    before, after = course.states[-2], course.states[-1]
    rounds, batch = screened
    network, kept = batch.children.genotypes, batch.counters
    numbers = np.asarray(network.innovation)[np.asarray(network.connection_used)]
    new = np.unique(numbers[numbers >= int(before.counters.innovation)])
    wanted = np.arange(int(before.counters.innovation), int(kept.innovation))
    np.testing.assert_array_equal(new, wanted)
    assert int(after.counters.innovation) == int(kept.innovation)
    largest = max(int(np.asarray(rows.innovation).max()) for rows in rounds)
    assert int(kept.innovation) <= largest, "candidates had more new genes"


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
