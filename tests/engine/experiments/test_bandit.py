"""Searches whose batches a bandit divides: their shares follow from the recorded outcomes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos import search
from microcosmos.archive import file
from microcosmos.experiments.offspring import divided, next_offspring

pytestmark = pytest.mark.long

RUNS = ["bandit", "screened-bandit"]


@pytest.fixture(scope="module", params=RUNS)
def course(request, course_of):
    return course_of(request.param)


def recorded(course):
    """The columns of `emitters` in the file: (generation, emitter)."""
    tree, _ = file.load(course.experiment.save(course.states[-1]))
    return tree["emitters"]


def test_recorded_outcomes_alone_decide_every_division(course):
    columns, plan = recorded(course), course.experiment.plan
    children, entered = columns["children"], columns["inserted"] + columns["improved"]
    batch = plan.batch
    assert children[0].tolist() == [batch // 2, batch // 4, batch // 4], "by their `share`"
    for number in range(1, len(children)):
        window = slice(max(0, number - 3), number)
        known = children[window].sum(0).tolist(), entered[window].sum(0).tolist()
        assert tuple(children[number].tolist()) == plan.bandit.slots(*known, batch)
    assert (children.sum(1) == batch).all()
    assert len(np.unique(children, axis=0)) > 2


def test_children_are_counted_for_the_emitter_that_made_them(course):
    """`random` is the only one of the three whose children have no parents."""
    random, experiment = search.OPERATORS.index("random"), course.experiment
    plan = experiment.plan
    for state in course.states[1:-1]:
        offspring = next_offspring(
            plan, experiment.programs, experiment.devices, state, search.never
        )
        of = divided(plan, state)
        operator = np.asarray(offspring.children.operator)
        assert ((operator == random) == (of == 1)).all()
        made = recorded(course)["children"][state.generation]
        assert np.bincount(of, minlength=3).tolist() == made.tolist()
    entered = recorded(course)["inserted"] + recorded(course)["improved"]
    for report, counts in zip(course.reports[1:], entered[1:], strict=True):
        assert len(report.elites) == counts.sum()
        assert sum(elite.operator == "random" for elite in report.elites) == counts[1]


def test_reports_show_the_division(course):
    children, names = recorded(course)["children"], course.experiment.plan.names
    for report, counts in zip(course.reports, children, strict=True):
        shown = [report.summary[f"{name}: children"] for name in names]
        assert shown == counts.tolist()


def test_the_order_in_which_children_arrive_changes_no_outcome(course):
    experiment = course.experiment
    state = course.states[2]
    offspring = next_offspring(
        experiment.plan, experiment.programs, experiment.devices, state, search.never
    )
    found = search.evaluate_blocks(
        experiment.programs.evaluate_block, offspring.children.genotypes, block=8
    )
    rows = search.candidates(
        state.generation + 1,
        offspring.children.genotypes,
        jnp.asarray(found.fitness),
        jnp.asarray(found.measures),
        jnp.asarray(found.status == 0),
    )
    elites, cells = course.states[2].elites, state.container
    expected = course.states[3].outcomes[-1]
    for seed in range(5):
        order = np.random.default_rng(seed).permutation(experiment.plan.batch)
        shuffled = jax.tree.map(lambda x, order=order: x[order], rows)
        _, inserted = jax.jit(search.insert)(elites, shuffled, cells)
        counts = experiment._outcomes(offspring.emitter[order], inserted)
        np.testing.assert_array_equal(counts, expected)
