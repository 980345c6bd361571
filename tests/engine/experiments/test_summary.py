"""What a search tells of a generation beside its curves."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from microcosmos.build import build
from microcosmos.search import tensorneat
from microcosmos.spec import parse


@pytest.fixture
def failing(experiment):
    """The small run, three of whose creatures in a block of eight have failed."""

    def evaluate(block):
        found = experiment.programs.evaluate_block(block)
        status = jnp.asarray([0, 1, 0, 2, 0, 1, 0, 0])
        return replace(found, status=status)

    return replace(experiment, programs=replace(experiment.programs, evaluate_block=evaluate))


def test_diverged_creatures_are_told_by_their_reasons(failing):
    _, report = failing.advance(failing.init())
    assert report.summary["diverged: non-finite"] == 4
    assert report.summary["diverged: supersonic"] == 2
    assert report.diverged == 6


def test_where_nothing_diverged_no_reason_is_told(course):
    reports = course.reports
    assert [report.diverged for report in reports] == [0, 0, 0, 0]
    assert not [name for report in reports for name in report.summary if "diverged" in name]


def sizes(report):
    return {
        int(n): int(m) for n, m in (one.split(":") for one in report.summary["species"].split())
    }


def test_every_member_of_a_generation_is_in_one_of_the_species_that_are_told(course_of):
    states, reports, *_ = course_of("neuroevolution")
    for state, report in zip(states[1:], reports, strict=True):
        told, species = sizes(report), state.emitters[0].species
        assert sum(told.values()) == 16
        of = np.asarray(species.number)[np.asarray(species.of)]
        assert told == {int(number): int((of == number).sum()) for number in np.unique(of)}


@pytest.mark.skipif(
    not tensorneat.available(), reason="tensorneat is not installed: make tensorneat"
)
@pytest.mark.filterwarnings("ignore")
def test_species_of_tensorneat_are_told_of_the_generation_that_was_measured(carry_out, specs):
    """As its own table of species counts them."""
    backend = {"backend": "tensorneat", "preset": "tensorneat", "threshold": 0.3}
    with jax.numpy_rank_promotion("allow"):
        states, reports = carry_out(build(parse(specs["neuroevolution"] | {"neat": backend})))
    assert sizes(reports[0]) == {0: 16}, "at first there is one"
    for state, report in zip(states[1:], reports, strict=True):
        arrays = state.emitters[0].arrays
        table = zip(arrays["species.species_keys"], arrays["species.member_count"], strict=True)
        assert sizes(report) == {int(key): int(count) for key, count in table if count > 0}
        assert sum(sizes(report).values()) == 16
    assert max(len(sizes(report)) for report in reports) > 1


def test_a_search_without_a_population_tells_no_species(course):
    assert not [report for report in course[1] if "species" in report.summary]
