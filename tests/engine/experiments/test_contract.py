"""Every experiment keeps the same contract: it repeats, resumes, stops and refuses."""

import json
from dataclasses import replace
from itertools import pairwise

import jax
import numpy as np
import pytest

from microcosmos.archive import creature, file
from microcosmos.build import build
from microcosmos.experiments import OtherDevice, OtherSpec, Stopped
from microcosmos.experiments.evolution import Evolution
from microcosmos.invalid import InvalidField
from microcosmos.search import loop
from microcosmos.spec import parse

LEARNERS = ("cma-mae", "cma-mega", "cma-me")
COMPUTED = (
    *("quality-diversity", "neuroevolution", "folding", "refinement", "gaits"),
    *("zoo", "screened", "learned", "several"),
)
CONTAINERS = ("dominated-novelty", "fronts")
LONG = ("zoo", "screened", "learned", "several", *LEARNERS, *CONTAINERS)
"""`make test` leaves them to `make test-all`: the others keep every part of the contract."""
OTHER = {
    "quality-diversity": {"task": {"steps": 61}},
    "neuroevolution": {"seed": 6},
    "folding": {"rate": 0.05},
    "refinement": {"block": 5},
    "gaits": {"period": 31},
    "scaling": {"steps": 11},
}
"""Changes that make another run of each."""


def marked(*names, long=LONG):
    return [pytest.param(name, marks=[pytest.mark.long] * (name in long)) for name in names]


@pytest.fixture(scope="module", params=marked(*COMPUTED, *LEARNERS, *CONTAINERS))
def computed(request, course_of):
    """A run whose numbers repeat, those of searches that learn among them."""
    with jax.numpy_rank_promotion("allow" if request.param in LEARNERS else "raise"):
        yield course_of(request.param)


@pytest.fixture(scope="module", params=OTHER)
def course(request, course_of):
    return course_of(request.param)


def without_times(report):
    summary = {name: value for name, value in report.summary.items() if "seconds" not in name}
    return replace(report, summary=summary)


@pytest.mark.filterwarnings("ignore")
def test_interrupted_after_any_generation_it_goes_on_with_the_same_bytes(computed, finish):
    states, reports, experiment, _ = computed
    files = [experiment.save(state) for state in states]
    for (before, after), expected in zip(pairwise(files), reports, strict=True):
        taken_up = experiment.restore(before)
        assert experiment.save(taken_up) == before
        state, report = experiment.advance(taken_up)
        assert experiment.save(state) == after
        assert without_times(report) == without_times(expected)
    assert finish(experiment, experiment.restore(files[1])) == files[-1]


@pytest.mark.filterwarnings("ignore")
def test_columns_that_grow_keep_the_bytes_of_all_rows_but_the_last(computed):
    """The store keeps them once for all checkpoints."""
    states, _, experiment, _ = computed
    if not isinstance(experiment, Evolution):
        assert not hasattr(experiment, "growing"), "rows of a table stand in one text"
        return
    files = [experiment.save(state) for state in states]
    assert {"curves", "emitters", "lineage"} <= set(experiment.growing)
    for before, after in pairwise(files):
        old, new = columns_of(before, experiment.growing), columns_of(after, experiment.growing)
        assert old.keys() == new.keys()
        for name, rows in old.items():
            kept = max(len(rows) - 1, 0)
            assert new[name][:kept].tobytes() == rows[:kept].tobytes(), name
    found = columns_of(files[-1], experiment.growing)
    whole = [files[-1][a:b] for a, b in file.extents(files[-1], experiment.growing)]
    assert sorted(whole) == sorted(rows.tobytes() for rows in found.values())


def columns_of(data, groups):
    tree, _ = file.load(data)
    return {f"{group}/{name}": rows for group in groups for name, rows in tree[group].items()}


@pytest.mark.parametrize(
    "name", marked(*COMPUTED, long=(*LONG, "neuroevolution", "refinement"))
)
def test_a_new_build_of_the_same_spec_gives_the_same_bytes(name, course_of, finish):
    states, _, experiment, spec = course_of(name)
    again = build(spec)
    assert finish(again, again.init()) == experiment.save(states[-1])


@pytest.mark.parametrize(
    ("name", "generations"),
    [
        ("quality-diversity", 2),
        ("neuroevolution", 3),
        pytest.param("learned", 2, marks=pytest.mark.long),
        pytest.param("neuroevolution", 4, marks=pytest.mark.long),
    ],
)
def test_an_extended_run_ends_like_a_longer_one(name, generations, course_of, finish, lasting):
    """Neuroevolution evaluates its elites again after 3 generations and at the end."""
    states, _, experiment, _ = course_of(name)
    shorter = lasting(experiment, generations)
    ended = finish(shorter, shorter.init())
    assert shorter.save(shorter.restore(ended)) == ended
    assert ended != experiment.save(states[generations]), "the file says that it is done"
    assert finish(experiment, experiment.restore(ended)) == experiment.save(states[-1])


def limited(experiment, limits):
    spec = json.loads(experiment.facts.spec)
    spec["search"]["stop"] = vars(limits)
    facts = replace(experiment.facts, spec=json.dumps(spec, sort_keys=True))
    return replace(experiment, plan=replace(experiment.plan, limits=limits), facts=facts)


def test_a_run_that_only_its_last_reevaluation_ended_is_extended(course_of, finish, lasting):
    """The limit is one evaluation more than a longer run has made after as many generations."""
    states, _, experiment, _ = course_of("neuroevolution")
    experiment = limited(experiment, loop.Limits(evaluations=states[4].evaluations + 1))
    shorter = lasting(experiment, 4)
    ended = finish(shorter, shorter.init())
    assert json.loads(file.load(ended)[1]["ended"])["reason"] == "evaluations"
    assert finish(experiment, experiment.restore(ended)) == finish(experiment, states[0])


@pytest.mark.parametrize("limit", ["evaluations", "fitness", "device_hours"])
def test_a_run_that_a_limit_ended_is_not_extended(limit, course_of, finish, lasting):
    _, _, experiment, _ = course_of("neuroevolution")
    experiment = limited(experiment, loop.Limits(**{limit: 0 if limit != "fitness" else -1e9}))
    shorter = lasting(experiment, 4)
    ended = finish(shorter, shorter.init())
    assert shorter.save(shorter.restore(ended)) == ended
    with pytest.raises(InvalidField, match=f"must stay 4, since `search.stop.{limit}` ended"):
        experiment.restore(ended)


def test_it_stops_when_it_is_asked_to_and_leaves_the_state_as_it_was(course):
    states, _, experiment, spec = course
    number = (len(states) - 1) // 2
    before, asked = experiment.save(states[number]), []
    experiment.advance(states[number], stop=lambda: bool(asked.append(None)))
    for last in (1, len(asked)):
        left = iter(range(last)[::-1])
        with pytest.raises(Stopped):
            experiment.advance(states[number], stop=lambda left=left: next(left) == 0)
        assert experiment.save(states[number]) == before
    if spec.experiment != "scaling":  # Times do not repeat.
        after, _ = experiment.advance(states[number])
        assert experiment.save(after) == experiment.save(states[number + 1])


def test_its_file_holds_the_spec_and_reads_back(course):
    states, _, experiment, spec = course
    for state in (states[0], states[1], states[-1]):
        data = experiment.save(state)
        assert json.loads(file.load(data)[1]["spec"]) == spec.model_dump(mode="json")
        restored = experiment.restore(data)
        assert experiment.save(restored) == data
        assert restored.generation == state.generation
        assert experiment.done(restored) == experiment.done(state)


def test_generations_are_counted_from_one(course):
    states, reports, _, _ = course
    assert [state.generation for state in states] == list(range(len(states)))
    assert [report.generation for report in reports] == list(range(1, len(states)))


def test_the_file_of_another_spec_is_refused(course):
    states, _, experiment, spec = course
    document = spec.model_dump(mode="json")
    for name, change in OTHER[spec.experiment].items():
        document[name] = document[name] | change if isinstance(change, dict) else change
    other = build(parse(document))
    with pytest.raises(OtherSpec, match="`spec` in the file must be the run's own"):
        other.restore(experiment.save(states[1]))


def test_a_file_without_a_part_is_refused(course):
    states, _, experiment, _ = course
    tree, attributes = file.load(experiment.save(states[1]))
    del tree["loop"]
    with pytest.raises(ValueError, match="must hold 'loop'"):
        experiment.restore(file.dump(tree, attributes))


def test_another_device_needs_leave_and_is_recorded(course):
    states, _, experiment, _ = course
    data = experiment.save(states[1])
    change = {"device": "abacus"}
    if hasattr(experiment, "facts"):
        change = {"facts": replace(experiment.facts, **change)}
    elsewhere = replace(experiment, **change)
    with pytest.raises(OtherDevice, match=r"`device` must be .*got 'abacus'"):
        elsewhere.restore(data)
    saved = elsewhere.save(elsewhere.restore(data, other_device=True))
    here, both = (json.loads(file.load(one)[1]["device"]) for one in (data, saved))
    assert both == [*here, "abacus"]


def test_its_best_creature_is_a_sound_file_and_there_is_none_at_first(course):
    states, reports, experiment, spec = course
    assert experiment.best(states[0]) is None
    best = experiment.best(states[-1])
    if spec.experiment in ("gaits", "scaling"):  # Rows do not compete.
        assert best is None
        return
    assert creature.parse(best)["sha256"] == best["sha256"]
    if spec.experiment != "folding":
        assert best["measured"]["fitness"] == reports[-1].best


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", marked(*LEARNERS))
def test_simulations_that_teach_are_counted(name, course_of):
    with jax.numpy_rank_promotion("allow"):
        states, reports, experiment, _ = course_of(name)
    assert np.asarray(states[-1].elites.occupied).sum() > 1
    taught = {"cma-mega": 5}.get(experiment.plan.names[0], 0)
    assert states[-1].evaluations == 40 + taught
    if taught:
        assert reports[-1].summary["slopes.finite"] == 1
        assert reports[-1].summary["slopes.length"] > 0
