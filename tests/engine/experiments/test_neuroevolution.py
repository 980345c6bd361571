"""A NEAT run: crossover, reevaluation, limits, and initial creatures."""

import json
from dataclasses import replace

import numpy as np
import pytest

from microcosmos.archive import file
from microcosmos.build import build
from microcosmos.spec import parse

EXPERIMENT = "neuroevolution"


@pytest.fixture(scope="module")
def searching(specs):
    """A function that changes the run's search."""

    def change(**parts):
        document = specs["neuroevolution"]
        return parse(document | {"search": document["search"] | parts})

    return change


@pytest.fixture(scope="module")
def limited(searching, experiment):
    """A function that stops the run at a limit; the programs stay the same."""

    def stopped(**stop):
        built = build(searching(stop=stop, reevaluation=None))
        compiled = {"steps": experiment.plan.steps, "evaluate": experiment.plan.evaluate}
        return replace(built, plan=replace(built.plan, **compiled))

    return stopped


def test_crossed_creatures_name_two_forebears(course):
    elites = [elite for report in course[1] for elite in report.elites]
    pairs = [elite for elite in elites if len(elite.parents) == 2]
    assert pairs
    assert any(elite.operator == "crossover" for elite in pairs)
    # A mutant of a crossed creature that was no elite names the two before it.
    assert {elite.operator for elite in pairs} <= {"crossover", "neat"}


def test_elites_are_evaluated_again_on_schedule_and_at_the_end(experiment, course):
    states, reports, *_ = course
    corrected = [report.summary.get("corrected_qd_score") for report in reports]
    assert [value is not None for value in corrected] == [False, False, True, False, True]
    final = states[-1]
    again = np.asarray(final.parts["reevaluation"].repeats.count)
    assert (again[np.asarray(final.elites.occupied)] >= 1).all()
    assert not again[~np.asarray(final.elites.occupied)].any()
    assert 0 <= reports[-1].summary["hit_rate"] <= 1
    elites = [np.asarray(states[number].elites.occupied).sum() for number in (3, 5)]
    assert [states[number].evaluations for number in (2, 3, 5)] == [
        32,
        48 + 4 * elites[0],
        80 + 4 * sum(elites),
    ]


@pytest.mark.parametrize(
    ("stop", "reason"), [({"evaluations": 30}, "evaluations"), ({"fitness": 1e-6}, "fitness")]
)
def test_a_limit_ends_a_run_and_is_recorded(stop, reason, limited, carry_out):
    run = limited(**stop)
    states, reports = carry_out(run)
    generations = 2 if reason == "evaluations" else 1
    assert states[-1].generation == generations
    assert reports[-1].summary[f"ended.{reason}"] == generations
    data = run.save(states[-1])
    _, attributes = file.load(data)
    assert json.loads(attributes["ended"]) == {"reason": reason, "generation": generations}
    assert run.done(run.restore(data))


def test_no_clock_is_in_a_file_unless_it_decides(experiment, course, limited):
    tree, _ = file.load(experiment.save(course[0][-1]))
    assert "device_seconds" not in tree["loop"]
    timed = limited(device_hours=1e-9)
    state, report = timed.advance(timed.init())
    assert timed.done(state)
    assert "ended.device_hours" in report.summary
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
