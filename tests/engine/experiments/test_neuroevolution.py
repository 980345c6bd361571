"""A NEAT run keeps whole lineages, tells of its species, and ends when it was asked to."""

import json

import numpy as np
import pytest

from microcosmos.archive import file
from microcosmos.build import build
from microcosmos.spec import parse

EXPERIMENT = "neuroevolution"


@pytest.fixture(scope="module")
def searching(specs):
    def change(**parts):
        document = specs["neuroevolution"]
        return parse({**document, "search": {**document["search"], **parts}})

    return change


def test_every_forebear_that_is_named_was_recorded_before(course):
    born, related = {}, 0
    for report in course[1]:
        for elite in report.elites:
            for parent in elite.parents:
                related += 1
                assert born[parent] < report.generation
        for elite in report.elites:
            born.setdefault(elite.creature, report.generation)
    assert related > 10


def test_crossed_creatures_name_two_forebears(course):
    elites = [elite for report in course[1] for elite in report.elites]
    pairs = [elite for elite in elites if len(elite.parents) == 2]
    assert pairs
    assert all(elite.operator == "crossover" for elite in pairs)


def test_the_fittest_creature_of_all_is_kept(course):
    bests = [report.best for report in course.reports]
    assert bests == sorted(bests)


def test_elites_are_evaluated_again_on_schedule_and_at_the_end(experiment, course):
    states, reports, *_ = course
    corrected = [report.summary.get("corrected_qd_score") for report in reports]
    assert [value is not None for value in corrected] == [False, False, True, False, True]
    final = states[-1]
    again = np.asarray(final.repeats.count)
    assert (again[np.asarray(final.elites.occupied)] >= 1).all()
    assert not again[~np.asarray(final.elites.occupied)].any()
    assert 0 <= reports[-1].summary["hit_rate"] <= 1


@pytest.mark.parametrize(
    ("stop", "reason"), [({"evaluations": 30}, "evaluations"), ({"fitness": 1e-6}, "fitness")]
)
def test_a_limit_ends_a_run_and_is_recorded(stop, reason, experiment, searching):
    limited = build(searching(stop=stop, reevaluation=None))
    # The same programs, so that only the limit differs.
    limited = type(limited)(limited.plan, experiment.programs)
    state = limited.init()
    generations = 2 if reason == "evaluations" else 1
    while not limited.done(state):
        state, report = limited.advance(state)
    assert state.generation == generations
    assert report.summary["ended"] == f"{reason} after generation {generations}"
    data = limited.save(state)
    _, attributes = file.load(data)
    assert json.loads(attributes["ended"]) == {"reason": reason, "generation": generations}
    assert limited.done(limited.restore(data))


def test_no_clock_is_in_a_file_unless_it_decides(experiment, course, searching):
    tree, _ = file.load(experiment.save(course[0][-1]))
    assert "device_seconds" not in tree["loop"]
    timed = build(searching(stop={"device_hours": 1e-9}, reevaluation=None))
    timed = type(timed)(timed.plan, experiment.programs)
    state, report = timed.advance(timed.init())
    assert timed.done(state)
    assert report.summary["ended"].startswith("device_hours")
    again = timed.restore(timed.save(state))
    assert again.device_seconds == state.device_seconds > 0


def test_a_population_begins_with_creatures_of_before(
    experiment, course, searching, finish, elite_files, forked_from
):
    files = elite_files(course, 5)
    names = sorted(file["sha256"] for file in files)
    fork = forked_from(experiment, searching(initial=names, generations=3), files)
    after, report = fork.advance(fork.init())
    mine = {elite.creature: elite for elite in report.elites}
    assert set(names) <= set(mine)
    assert all((mine[n].operator, mine[n].parents) == ("fork", ()) for n in names)
    assert {e.operator for e in report.elites} == {"fork", "random"}
    later, second = fork.advance(after)
    assert any(set(elite.parents) & set(names) for elite in second.elites)
    assert finish(fork, fork.restore(fork.save(after))) == finish(fork, later)
