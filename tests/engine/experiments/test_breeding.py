"""Breeding by eye: chosen creatures have offspring; the same choices give the same bytes."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from microcosmos.archive import choices
from microcosmos.build import build, local
from microcosmos.search.parts.breeding import BRED, UnknownCreature
from microcosmos.spec import breeding_refusal, parse

OPERATORS = {"neat", "crossover", "iso+line", "gaussian"}
AFTER = 2
"""Generations before the choice."""


@pytest.fixture(scope="module")
def numbers(small):
    """A search whose genomes are numbers, half of them from `random`."""
    emitters = [{"operator": "iso+line"}, {"operator": "random"}]
    return small(control={"encoding": "direct"}, search={"emitters": emitters})


RUNS = ["quality-diversity", "numbers", pytest.param("screened", marks=pytest.mark.long)]


@pytest.fixture(scope="module", params=RUNS)
def course(request, course_of, numbers, carry_out):
    """A run without choices: its states, experiment and spec."""
    if request.param == "numbers":
        experiment = build(numbers)
        return carry_out(experiment)[0], experiment, numbers
    states, _, experiment, spec = course_of(request.param)
    return states, experiment, spec


@pytest.fixture(scope="module")
def experiment(course):
    return course[1]


@pytest.fixture(scope="module")
def files(course):
    """Two elites of the archive before the choice."""
    states, experiment, _ = course
    cells = np.flatnonzero(states[AFTER].elites.occupied)[:2].tolist()
    return [experiment.creature(states[AFTER], cell) for cell in cells]


@pytest.fixture(scope="module")
def bred(course, files):
    """The rest of the run with the choice: its states and reports."""
    states, experiment, _ = course
    state, reports = experiment.receive(states[AFTER], "breeding", files), []
    states = [state]
    while not experiment.done(state):
        state, report = experiment.advance(state)
        states.append(state)
        reports.append(report)
    return states, reports


def refusal(spec):
    return breeding_refusal(spec.model_dump(mode="json"))


def changed(experiment, **breeding):
    """Return the run with other settings of breeding."""
    document = json.loads(experiment.facts.spec)
    document["search"]["breeding"] |= breeding
    return build(parse(document))


def test_half_of_the_next_batch_descends_from_the_chosen_and_the_rest_is_as_before(
    course, files, bred
):
    states, experiment, _ = course
    found, own = experiment.propose(bred[0][0]), experiment.propose(states[AFTER])
    of_chosen = found.emitter == BRED
    assert of_chosen.sum() == experiment.plan.batch // 2
    parents = np.asarray(found.children.parents)
    names = {bytes(found.names[n]).hex() for n in parents[of_chosen].ravel() if n >= 0}
    assert names == {file["sha256"] for file in files}
    np.testing.assert_array_equal(parents[~of_chosen], own.children.parents[~of_chosen])
    counts = [report.summary["emitter.chosen.children"] for report in bred[1]]
    assert counts[:2] == [8, 7], "of 16, with a half-life of 10 generations"


def test_lineage_names_the_chosen_as_parents(files, bred):
    chosen, reports = {file["sha256"] for file in files}, bred[1]
    elites = [elite for report in reports for elite in report.elites]
    descended = [elite for elite in elites if chosen & set(elite.parents)]
    entered = [
        sum(report.summary[f"emitter.chosen.{name}"] for name in ("inserted", "improved"))
        for report in reports
    ]
    assert len(descended) >= sum(entered) > 0
    assert {elite.operator for elite in descended} <= OPERATORS


def test_the_part_of_the_chosen_fades_with_the_half_life(experiment, bred):
    fast = changed(experiment, half_life=1)
    counts, state = [], bred[0][0]
    for later in range(7):
        aged = replace(state, generation=state.generation + later)
        counts.append(int((fast.propose(aged).emitter == BRED).sum()))
    assert counts == [8, 4, 2, 1, 0, 0, 0]


def test_newer_choices_have_more_offspring_than_older_ones(course, files):
    states, experiment, _ = course
    fast = changed(experiment, share=1.0, half_life=0.25)
    state = fast.receive(states[AFTER], "breeding", files[:1])
    later = replace(state, generation=state.generation + 1)
    found = fast.propose(fast.receive(later, "breeding", files[1:]))
    first = np.asarray(found.children.parents)[found.emitter == BRED, 0]
    names = [bytes(found.names[place]).hex() for place in first]
    assert len(names) == fast.plan.batch
    assert names.count(files[1]["sha256"]) > 3 * names.count(files[0]["sha256"])


def test_a_run_with_choices_goes_on_from_any_file_with_the_same_bytes(experiment, bred):
    saved = [experiment.save(state) for state in bred[0][1:]]
    for before, after in pairwise(saved):
        restored = experiment.restore(before)
        assert experiment.save(restored) == before
        assert experiment.save(experiment.advance(restored)[0]) == after


@pytest.mark.long
def test_spec_and_exported_choices_repeat_the_run_whole_or_resumed(
    course, files, bred, tmp_path
):
    _, experiment, spec = course
    exported = choices.document([(AFTER + 1, file["sha256"]) for file in files], files)
    given = choices.parse(json.dumps(exported).encode())
    expected, reports = experiment.save(bred[0][-1]), []
    path = tmp_path / "resumed.h5"

    def stop():
        return len(reports) > AFTER

    assert not local.evolve(spec, path, stop=stop, tell=reports.append, choices=given)
    assert len(reports) == AFTER + 1
    assert local.evolve(spec, path, choices=given)
    assert path.read_bytes() == expected
    with pytest.raises(ValueError, match="`choices` must be those of the archive"):
        local.evolve(spec, path, choices={**given, AFTER: files})


def test_a_creature_that_never_entered_is_refused(course, files):
    states, experiment, _ = course
    with pytest.raises(UnknownCreature, match="`choices` of generation 1 must be creatures"):
        experiment.receive(states[0], "breeding", files)


def test_searches_that_cannot_descend_from_chosen_creatures_say_why(small, specs):
    assert refusal(small()) is None
    for name, reason in {
        "neuroevolution": "draw no parents from an archive, got 'neuroevolution'",
        "cma-mae": "got 'cma-mae', which learns from all of its offspring",
        "folding": "draw no parents from an archive, got 'folding'",
    }.items():
        assert reason in str(refusal(parse(specs[name])))
    idle = small(search={"emitters": [{"operator": "random"}]})
    assert "got only 'random', whose parents cannot be chosen" in str(refusal(idle))


def test_a_file_of_choices_needs_the_file_of_each_creature(files):
    row = [(3, files[0]["sha256"])]
    found = choices.parse(json.dumps(choices.document(row, files)).encode())
    assert found == {3: [files[0]]}
    with pytest.raises(ValueError, match="`creatures` needs the file of each choice"):
        choices.parse(json.dumps(choices.document(row, [])).encode())
    with pytest.raises(ValueError, match=r"`choices\.0\.generation` needs greater than"):
        choices.parse(json.dumps(choices.document([(1, row[0][1])], files)).encode())
