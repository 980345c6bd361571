"""Breeding by eye: chosen creatures have offspring, and the same choices give the same bytes."""

import numpy as np
import pytest

from microcosmos import search
from microcosmos.experiments.offspring import BRED, next_offspring

ROW = {"generation": 3}
"""The generation from which choices count in these tests."""


def with_choice(experiment, state, files):
    """The rest of a run whose `files` count from the next generation on: states and reports."""
    states, reports = [experiment.choose(state, files)], []
    while not experiment.done(states[-1]):
        state, report = experiment.advance(states[-1])
        states.append(state)
        reports.append(report)
    return states, reports


@pytest.fixture(
    scope="module",
    params=[
        "quality-diversity",
        *(pytest.param(n, marks=pytest.mark.long) for n in ("zoo", "bandit")),
    ],
)
def course(request, course_of):
    return course_of(request.param)


@pytest.fixture(scope="module")
def experiment(course):
    return course.experiment


@pytest.fixture(scope="module")
def files(course):
    """Two elites of the archive before the choice."""
    state, experiment = course.states[2], course.experiment
    cells = np.flatnonzero(state.elites.occupied)[:2]
    return [experiment.creature(state, cell) for cell in cells.tolist()]


@pytest.fixture(scope="module")
def bred(course, files):
    return with_choice(course.experiment, course.states[2], files)


def test_half_of_the_next_batch_descends_from_the_chosen_alone(course, files, bred):
    (chosen, *_), reports = bred
    plan, programs = course.experiment.plan, course.experiment.programs
    given = plan, programs, course.experiment.devices
    found = next_offspring(*given, chosen, search.never)
    own = next_offspring(*given, course.states[2], search.never)
    bred_slots = found.emitter == BRED
    assert bred_slots.sum() == plan.batch // 2
    parents = np.asarray(found.children.parents)[bred_slots]
    names = [bytes(found.names[place]).hex() for place in parents[parents >= 0].tolist()]
    assert set(names) == {file["sha256"] for file in files}
    rest = np.asarray(found.children.parents)[~bred_slots]
    assert (rest == np.asarray(own.children.parents)[~bred_slots]).all()
    assert reports[0].summary["chosen: children"] == plan.batch // 2


def test_lineage_names_the_chosen_as_parents(files, bred):
    chosen = {file["sha256"] for file in files}
    elites = [elite for report in bred[1] for elite in report.elites]
    entered = sum(
        report.summary[f"chosen: {name}"]
        for report in bred[1]
        for name in ("inserted", "improved")
    )
    descended = [elite for elite in elites if chosen & set(elite.parents)]
    assert len(descended) >= entered > 0
    assert {elite.operator for elite in descended} <= {
        "neat",
        "crossover",
        "iso+line",
        "gaussian",
    }
