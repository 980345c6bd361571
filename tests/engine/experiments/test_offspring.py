"""A search that begins from creatures of another, and the lineage that goes through it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from microcosmos.archive import creature
from microcosmos.archive.initial import fitting, renumbered
from microcosmos.build import build
from microcosmos.build.scene import identity_template
from microcosmos.naming import decode, encode
from microcosmos.search.parts.breeding import BRED
from microcosmos.spec import parse

GAUSSIAN = {"emitters": [{"operator": "gaussian"}]}


@pytest.fixture(scope="module")
def files(course, elite_files):
    return elite_files(course, 20)


def names_of(files):
    return sorted(file["sha256"] for file in files)


@pytest.fixture(scope="module")
def forked(small, files):
    """In another viscosity, from more creatures than a batch holds."""
    spec = small(
        world={"width": 32, "height": 32, "viscosity": 0.2},
        search={"initial": names_of(files), "generations": 4},
    )
    return build(spec, files)


@pytest.fixture(scope="module")
def forking(forked, carry_out):
    return carry_out(forked)


def test_initial_creatures_are_evaluated_first_each_once(forked, forking, files):
    _, reports = forking
    assert [report.evaluations for report in reports] == [16, 32, 48, 64]
    begun = [e for report in reports for e in report.elites if e.operator == "fork"]
    assert {e.generation for e in begun} == {1, 2}
    sources = {file["sha256"]: file["identity"]["genome"] for file in files}
    assert len({e.parents for e in begun}) == len(begun)
    for elite in begun:
        (parent,) = elite.parents
        assert json.loads(elite.identity)["genome"] == sources[parent], "the very same genes"
        assert elite.creature != parent
        assert json.loads(elite.identity)["world"]["viscosity"] == 0.2


def test_the_first_generation_begins_with_initial_creatures(forked, forking):
    known = {file["sha256"] for file in forked.first_generation()}
    assert {elite.creature for elite in forking[1][0].elites} <= known


def test_initial_creatures_are_no_emitters_children(forking, files):
    children = forking[0][-1].parts["outcomes"].counts[:, 0, 0].tolist()
    assert children == [0, 32 - len(files), 16, 16]


def test_later_creatures_descend_from_the_initial_ones(forking, files):
    recorded, initial = set(), set(names_of(files))
    for report in forking[1]:
        for elite in report.elites:
            assert elite.operator in ("fork", "neat")
            assert elite.parents
            assert set(elite.parents) <= recorded | initial
        recorded |= {elite.creature for elite in report.elites}


FEW = {"descriptors": [{"name": "symmetry", "bins": 2}, {"name": "curvature_mean", "bins": 2}]}


def test_parents_are_named_while_the_initial_creatures_outnumber_the_cells(small, files):
    names = names_of(files)
    few = build(small(archive=FEW, search={"initial": names, "generations": 3}), files)
    state, _ = few.advance(few.init())
    chosen = few.best(state)
    batch = few.propose(few.receive(state, "breeding", [chosen]))
    first = [bytes(batch.names[parent]).hex() for parent in batch.children.parents[:, 0]]
    assert few.plan.cell_count == 4
    assert first[:4] == names[16:]
    bred = batch.emitter == BRED
    assert bred.any()
    assert {first[slot] for slot in np.flatnonzero(bred)} == {chosen["sha256"]}
    others = ~bred & (batch.emitter >= 0)
    assert {first[slot] for slot in np.flatnonzero(others)} <= set(names[:4])


@pytest.mark.long
def test_a_fork_taken_up_from_any_generation_ends_the_same(forked, forking, finish, lasting):
    states, _ = forking
    whole = forked.save(states[-1])
    alone = replace(forked, plan=build(parse(json.loads(forked.facts.spec))).plan)
    for state in states[:-1]:
        assert finish(alone, alone.restore(forked.save(state))) == whole
    shorter = lasting(forked, 1)
    assert finish(alone, alone.restore(finish(shorter, shorter.init()))) == whole
    with pytest.raises(ValueError, match=r"`search.initial` names \d+ creatures"):
        alone.init()


def test_creatures_forked_into_their_own_world_keep_their_identity(
    small, experiment, files, finish, forked_from
):
    """They fill the first batch, so no child takes the cell of one of them."""
    names = names_of(files)[:16]
    chosen = small(search={"initial": names, "generations": 2})
    again = forked_from(experiment, chosen, files)
    state, report = again.advance(again.init())
    known = {file["sha256"]: file["measured"]["fitness"] for file in files}
    assert {e.creature: e.fitness for e in report.elites} == {n: known[n] for n in names}
    assert {(e.operator, e.parents) for e in report.elites} == {("fork", ())}
    document = again.creature(state, report.elites[0].cell)
    assert creature.parse(document)["provenance"]["parents"] == []
    _, second = again.advance(state)
    assert second.elites
    assert all(e.parents and set(e.parents) <= set(names) for e in second.elites)
    assert finish(again, again.restore(again.save(state))) == finish(again, again.init())


def test_numbers_of_one_run_stay_and_those_of_another_do_not_mix(files):
    genomes = [file["identity"]["genome"] for file in files]
    assert renumbered(genomes, 5, 2) == genomes
    grown = next(one for one in genomes if len(one["connections"]["innovation"]) > 10)
    foreign = json.loads(json.dumps(grown))
    genes = foreign["connections"]
    genes["innovation"] = [*genes["innovation"][:-1], 90]
    stranger = json.loads(json.dumps(foreign))
    ends = stranger["connections"]
    ends["source"][-1], ends["target"][-1] = 1, 6
    assert (genes["source"][-1], genes["target"][-1]) != (1, 6)
    kept, moved = renumbered([foreign, stranger], 5, 2)
    assert kept == foreign
    numbers = moved["connections"]["innovation"]
    assert numbers == sorted(numbers)
    assert numbers[-1] > 90
    assert numbers[:10] == list(range(10)), "newcomers' genes mean the same to all"
    weights = (decode(one["weight"]) for one in (moved["connections"], ends))
    np.testing.assert_allclose(*weights, rtol=1e-6)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"genome": {"max_nodes": 10, "max_connections": 10}}, "genome.max_"),
        ({"control": {"timer": "linear"}}, "control.inputs"),
        ({"control": {"encoding": "direct"}, "search": GAUSSIAN}, "control.encoding"),
    ],
)  # fmt: skip
def test_creatures_that_do_not_fit_are_refused_with_the_field(small, files, changes, field):
    large = max(files, key=lambda file: len(file["identity"]["genome"]["nodes"]["id"]))
    grown = json.loads(json.dumps(large))
    nodes = grown["identity"]["genome"]["nodes"]
    nodes["id"] = [*nodes["id"], *range(1000, 1008)]
    with pytest.raises(creature.CreatureError) as raised:
        fitting(small(**changes), grown)
    assert raised.value.field.startswith(field)


def test_vectors_need_the_same_body_and_terms(small):
    direct = {"encoding": "direct", "terms": 2}
    chosen = small(control=direct, search=GAUSSIAN)
    scene = chosen.scene
    genome = {**identity_template(scene)["genome"], "values": encode(np.zeros(4 * (10 + 11)))}
    identity = {**identity_template(scene), "genome": genome}
    file = creature.parse(creature.document(identity, None, None))
    assert fitting(chosen, file) == file["identity"]["genome"]
    for changes, field in (
        ({"terms": 3}, "control.terms"),
        ({"waveform": "table"}, "control."),
    ):
        other = chosen.model_copy(update={"control": chosen.control.model_copy(update=changes)})
        with pytest.raises(creature.CreatureError, match=field):
            fitting(other, file)
    longer = small(body={"nodes": 13}, control=direct, search=GAUSSIAN)
    with pytest.raises(creature.CreatureError, match="`body` needs as many joints as"):
        fitting(longer, file)


def test_the_order_in_which_creatures_are_named_changes_nothing(small):
    names = [letter * 64 for letter in "cab"]
    orders = (names, [*names[::-1], names[0]])
    one, other = (small(search={"initial": order}) for order in orders)
    assert one == other
    assert one.search.initial == tuple(sorted(names))
    with pytest.raises(ValueError, match="initial"):
        small(search={"initial": ["nonsense"]})
