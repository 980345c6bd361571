"""Outcomes of several emitters: whose children entered the archive."""

import numpy as np
import pytest

from microcosmos import search

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def course(course_of):
    return course_of("several")


def test_children_are_counted_for_the_emitter_that_made_them(course):
    """`random` is the only one of the three whose children have no parents."""
    random, outcomes = (
        search.OPERATORS.index("random"),
        course.states[-1].parts["outcomes"].counts,
    )
    children, entered = outcomes[..., 0], outcomes[..., 1:].sum(-1)
    assert children.tolist() == [[8, 4, 4]] * len(children), "by their `share`"
    for state in course.states[1:-1]:
        operator = np.asarray(course.experiment.propose(state).children.operator)
        assert (operator == random).tolist() == [False] * 8 + [True] * 4 + [False] * 4
    for report, counts in zip(course.reports[1:], entered[1:], strict=True):
        assert len(report.elites) == counts.sum()
        assert sum(elite.operator == "random" for elite in report.elites) == counts[1]
