"""A small search for bodies: creature files, forks, and numbers of segments."""

import copy
from functools import reduce
from operator import getitem

import numpy as np
import pytest

from microcosmos.archive import creature
from microcosmos.archive.initial import counters, genes_of
from microcosmos.build import build
from microcosmos.naming import decode, encode
from microcosmos.spec import parse

pytestmark = pytest.mark.long

EXPERIMENT = "zoo"
PLAN = ("identity", "genome", "plan")


@pytest.fixture(scope="module")
def files(course, elite_files):
    return elite_files(course)


@pytest.fixture(scope="module")
def largest(files):
    """The file of the creature with the most segments."""
    return max(files, key=lambda file: len(file["identity"]["genome"]["plan"]["number"]))


def floats(*values):
    return lambda old: encode(np.resize(np.float32(values), len(decode(old))))


def first(value):
    return lambda old: [value, *old[1:]]


def last(value):
    return lambda old: [*old[:-1], value]


@pytest.mark.parametrize(
    ("field", "change", "message"),
    [
        ("number", last(0), "plan.number"),
        ("number", lambda old: old[:-1], "columns of one length"),
        ("number", lambda old: [], "number"),
        ("parent", last(31), "plan.parent"),
        ("parent", first(1), "plan.parent"),
        ("parent", last(-1), "parent"),
        ("place", floats(1.5), "plan.place"),
        ("place", floats(float("nan")), "place"),
        ("place", lambda old: "not base64!", "place"),
        ("angle", floats(4), "plan.angle"),
        ("curl", floats(-7), "plan.curl"),
        ("stiffness", floats(-0.1), "plan.stiffness"),
        ("nodes", last(0), "plan.nodes"),
        ("nodes", last(16), "plan.nodes"),
        ("copies", last(0), "plan.copies"),
        ("copies", last(7), "plan.copies"),
        ("mirrored", last("perhaps"), "mirrored"),
        ("closed", last(None), "closed"),
    ],
)
def test_a_bad_plan_is_refused_by_its_field(largest, field, change, message):
    changed = copy.deepcopy(largest)
    plan = reduce(getitem, PLAN, changed)
    plan[field] = change(plan[field])
    with pytest.raises(creature.CreatureError) as caught:
        creature.parse(changed)
    assert message in str(caught.value)


def test_a_plan_with_more_segments_than_its_body_is_refused(largest):
    changed = copy.deepcopy(largest)
    plan = reduce(getitem, PLAN, changed)
    for name, column in plan.items():
        one = decode(column) if isinstance(column, str) else column
        more = [*one, *one[-1:] * 5] if isinstance(one, list) else np.resize(one, len(one) + 5)
        plan[name] = encode(more) if isinstance(column, str) else more
    plan["number"] = list(range(len(plan["number"])))
    with pytest.raises(creature.CreatureError, match="at most 4 segments"):
        creature.parse(changed)


def test_a_search_begins_from_creatures_and_gives_new_segments_new_numbers(course, files):
    document = course.spec.model_dump(mode="json")
    names = sorted(file["sha256"] for file in files)
    document["search"] |= {"initial": names, "generations": 2}
    chosen = parse(document)
    ordered = sorted(files, key=lambda file: file["sha256"])
    experiment = build(chosen, ordered)
    state = experiment.init()
    taken = genes_of(chosen, ordered)
    most = counters(taken)[2]
    assert int(state.counters.segment) >= most
    while not experiment.done(state):
        state, _ = experiment.advance(state)
    assert experiment.save(experiment.restore(experiment.save(state))) == experiment.save(state)
    before = {n for genes in taken for n in genes["plan"]["number"]}
    plan = state.elites.genotypes.plan
    found = set(np.asarray(plan.number)[np.asarray(plan.used)].tolist())
    assert found & before
    assert all(n in before or n >= most or n <= 2 for n in found)


def test_a_body_with_less_room_refuses_an_initial_plan(course, largest):
    document = course.spec.model_dump(mode="json")
    document["body"]["segments"] = 1
    document["search"] |= {"initial": [largest["sha256"]]}
    with pytest.raises(creature.CreatureError, match="room for the plan"):
        genes_of(parse(document), [largest])
