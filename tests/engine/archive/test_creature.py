"""Creature files of every encoding and pedigree: parsed, checked and refused."""

import copy
import json
from functools import reduce
from operator import getitem

import numpy as np
import pytest

from microcosmos import spec
from microcosmos.archive import choices, creature, creature_h5, export, pedigree
from microcosmos.archive import file as archive_file
from microcosmos.build import identity_template
from microcosmos.invalid import InvalidField
from microcosmos.naming import encode
from microcosmos.spec import EXPERIMENTS

pytestmark = pytest.mark.fast

IDENTITY = {
    "format": "microcosmos-creature/1",
    "genome": {
        "encoding": "cppn",
        "inputs": ["position", "sine", "cosine"],
        "outputs": ["rest_angle", "rest_length"],
        "control": {"wave_number": None},
        "nodes": {
            "id": [0, 1, 2, 3, 4, 9],
            "activation": ["identity"] * 3 + ["sin", "tanh", "gaussian"],
            "bias": encode([0, 0, 0, 0.5, -1, 2]),
        },
        "connections": {
            "innovation": [0, 4, 7, 8],
            "source": [0, 1, 2, 9],
            "target": [3, 4, 9, 4],
            "enabled": [True, True, False, True],
            "weight": encode([1, -2, 0.25, 3]),
        },
    },
    "world": {"coupling": {}},
    "body": {},
    "task": {},
}


@pytest.fixture
def file():
    """A valid creature file, all defaults written out."""
    parsed = creature.Identity.model_validate(IDENTITY)
    return creature.document(parsed.model_dump(mode="json"), None, None)


def refused(file, *changes) -> creature.CreatureError:
    """The error of a file after changes: the path of a field and its new value."""
    changed = copy.deepcopy(file)
    for (*path, last), value in changes:
        reduce(getitem, path, changed)[last] = value
    with pytest.raises(creature.CreatureError) as caught:
        creature.parse(changed)
    return caught.value


def test_a_valid_file_comes_back_as_it_was(file):
    assert creature.parse(json.dumps(file)) == file


def test_the_name_does_not_depend_on_how_the_json_is_written(file):
    other = json.loads(json.dumps(file["identity"], indent=4, sort_keys=True))
    other["world"]["viscosity"] = 5e-2
    assert creature.name(other) == file["sha256"]


GENES = ("identity", "genome")
LINKS = (*GENES, "connections")


def test_a_changed_gene_is_noticed(file):
    error = refused(file, ((*LINKS, "weight"), encode([1, -2, 0.25, 4])))
    assert error.field == "sha256"
    assert error.got == file["sha256"]


@pytest.mark.parametrize(
    ("field", "value", "where"),
    [
        ((*GENES, "nodes", "activation"), ["identity"] * 5 + ["step"], "activation"),
        ((*GENES, "nodes", "bias"), "AAAA", "bias"),
        ((*GENES, "nodes", "bias"), "not base64!", "bias"),
        ((*GENES, "nodes", "bias"), encode([0, 0, 0, float("nan"), 0, 0]), "bias"),
        ((*GENES, "nodes", "id"), [0, 1, 2, 3, 9, 4], "genome"),
        ((*LINKS, "source"), [0, 1, 2, 77], "genome"),
        ((*LINKS, "target"), [3, 4, 9, 0], "genome"),
        ((*LINKS, "target"), [3, 4, 9, 9], "genome"),
        ((*LINKS, "innovation"), [0, 4, 4, 8], "genome"),
        ((*GENES, "inputs"), ["position", "time"], "genome"),
        ((*GENES, "outputs"), ["rest_length", "rest_angle"], "genome"),
        ((*GENES, "nodes", "bias"), encode([1, 0, 0, 0.5, -1, 2]), "genome"),
        (("identity", "world", "viscosity"), -1, "viscosity"),
        (("identity", "world", "gravity"), 9.8, "gravity"),
        (("identity", "body", "nodes"), 500, "identity"),
        (("identity", "format"), "microcosmos-creature/9", "format"),
        (("sha256",), "cafe", "sha256"),
        (("extra",), 1, "extra"),
    ],
)
def test_a_malformed_file_is_refused_by_its_field(file, field, value, where):
    assert where in refused(file, (field, value)).field


def test_text_that_is_no_json_is_a_value_error():
    with pytest.raises(creature.CreatureError, match="`file` needs JSON"):
        creature.parse("{")


def measured(**changes):
    figures = {"fitness": 2.0, "descriptors": {"bending_effort": 0.5}}
    figures["measures"] = {"speed": 2.0, "bending_effort": 0.5}
    return figures | {"block": 16, "room": [8, 16], "device": "cpu"} | changes


@pytest.mark.parametrize(
    "changes",
    [
        {"fitness": 3.0},
        {"descriptors": {"bending_effort": 0.6}},
        {"measures": {}},
        {"room": [-1, 16]},
        {"room": [10**30, 16]},
        {"block": 0},
        {"measures": {"speed": 2.0, "bending_effort": 0.5, "stride": True}},
        {"measures": {"speed": 2.0, "bending_effort": 0.5, "stride": "1"}},
        {"room": ["8", 16]},
    ],
)
def test_a_measurement_that_contradicts_itself_is_refused(file, changes):
    assert "measured" in refused(file | {"measured": measured(**changes)}).field


def test_room_for_fewer_genes_than_there_are_is_refused(file):
    ids = list(range(5)) + list(range(9, 13))
    nodes = file["identity"]["genome"]["nodes"]
    nodes["id"], nodes["activation"] = ids, ["identity"] * 9
    nodes["bias"] = encode([0] * 9)
    file["sha256"] = creature.name(file["identity"])
    assert creature.parse(file)
    error = refused(file | {"measured": measured()})
    assert "`measured.room` must be at least" in str(error)


GENOME = IDENTITY["genome"]
CYCLE = {"source": [0, 1, 9, 9], "enabled": [True] * 4}
NETWORK = {"nodes": GENOME["nodes"], "connections": GENOME["connections"] | CYCLE}


CHAIN = spec.Chain(nodes=6)


def document(control, genes):
    identity = identity_template(spec.Scene(body=CHAIN, control=control))
    identity["genome"] |= genes
    return creature.document(identity, None, None)


def values(control, largest=1):
    count = spec.gene_count(control, spec.shape(CHAIN))
    return {"values": encode(np.linspace(-largest, largest, count))}


VECTORS = [spec.Direct(bend=spec.Bounds(low=0.1, high=0.9)), spec.Direct(terms=3)]


@pytest.mark.parametrize("control", VECTORS)
def test_vectors_come_back(control):
    file = document(control, values(control))
    assert creature.parse(file) == file
    assert creature.room(file) is None
    assert creature.scene_of(file).control == control


@pytest.mark.parametrize("control", VECTORS)
def test_vectors_of_another_length_or_beyond_one_are_refused(control):
    short = document(control, {"values": encode(np.zeros(3))})
    with pytest.raises(creature.CreatureError, match=r"must hold \d+ numbers, got 3"):
        creature.parse(short)
    wide = document(control, values(control, 1.5))
    with pytest.raises(creature.CreatureError, match="-1 to 1") as caught:
        creature.parse(wide)
    assert caught.value.field == "identity.genome.values"


def test_only_recurrent_networks_have_cycles():
    file = document(spec.Control(wave_number=None, recurrent=True), NETWORK)
    assert creature.parse(file) == file
    with pytest.raises(creature.CreatureError, match="free of cycles"):
        creature.parse(document(spec.Control(wave_number=None), NETWORK))


def one(period, *parents):
    gaits = EXPERIMENTS["gaits"].presets[0].spec
    identity = identity_template(gaits.scene("ours", "worm", 0.5))
    identity["genome"]["period"] = period
    names = [parent["sha256"] for parent in parents]
    origin = {"operator": "hand-made", "generation": 0, "seed": 0, "version": "0"}
    return creature.parse(creature.document(identity, None, {"parents": names, **origin}))


def test_a_family_is_taken_apart_as_it_was_put_together():
    oldest = one(40) | {"credit": ["Ada"], "licence": "CC0-1.0"}
    parent = one(60, oldest)
    young = one(80, parent, oldest)
    family = (young, [parent, oldest])
    assert pedigree.split(pedigree.document(*family)) == family
    assert pedigree.split(young) == (young, [])


def test_readers_of_one_creature_leave_its_ancestors_out(file):
    oldest = one(40)
    young = one(80, oldest)
    whole = pedigree.document(young, [oldest])
    assert creature.parse(whole) == young
    assert creature_h5.read(json.dumps(whole).encode()) == young
    chosen = choices.document([(2, young["sha256"])], [whole])
    assert choices.parse(json.dumps(chosen).encode()) == {2: [young]}
    refined = spec.Refinement(creature=pedigree.document(file, []))
    assert refined == spec.Refinement(creature=file)
    nested = pedigree.document(young, [pedigree.document(oldest, [])])
    with pytest.raises(creature.CreatureError) as caught:
        pedigree.split(nested)
    assert caught.value.field == "ancestors.0.ancestors"


def test_a_wrong_creature_among_choices_is_named_with_its_place():
    first, second = one(40), one(60)
    broken = second | {"credit": [""]}
    for files, field in (
        ([first, broken], "creatures.1.credit.0"),
        ([first] * 2, "creatures.1"),
    ):
        document = choices.document([(2, first["sha256"])], files)
        with pytest.raises(InvalidField) as caught:
            choices.parse(json.dumps(document).encode())
        assert caught.value.field == field


def test_a_file_of_choices_is_json_that_names_each_field_once():
    twice = json.dumps(one(40)).replace('"licence"', '"licence": "CC0-1.0", "licence"')
    for text, field in (
        ('{"choices": [], "choices": [], "creatures": []}', "choices"),
        (f'{{"choices": [], "creatures": [{twice}]}}', "creatures.0.licence"),
        ("{", "file"),
        ("[]", "file"),
    ):
        with pytest.raises(creature.CreatureError) as caught:
            choices.parse(text.encode())
        assert caught.value.field == field


def test_descendants_of_several_creatures_are_under_all_their_terms():
    new, terms = one(40), {"licence": "CC-BY-NC-4.0", "credit": ["Ada", "Bo"]}
    shared, free = new | terms, new | {"credit": ["Bo", "Cy"]}
    both = {"licence": "CC-BY-4.0 AND CC-BY-NC-4.0", "credit": ["Bo", "Cy", "Ada"]}
    for files, expected in (
        ([], {}),
        ([new], {}),
        ([new, shared], terms),
        ([free, shared, new], both),
    ):
        assert export.joint_terms(files) == expected


def test_a_file_has_room_for_the_terms_of_a_crowd():
    new, texts = one(40), [letter * 10_000 for letter in "ab"]
    names = [f"Ada {i}" for i in range(3000)]
    crowd = [new | {"licence": texts[i % 2], "credit": [name]} for i, name in enumerate(names)]
    terms = export.joint_terms(crowd)
    assert terms == {"licence": " AND ".join(texts), "credit": names}
    assert creature.parse(json.dumps(new | terms)) == new | terms
    data = export.licensed(archive_file.dump({}, {"format": archive_file.FORMAT}), **terms)
    assert export.terms(archive_file.load(data)[1]) == terms


@pytest.mark.parametrize(
    ("licences", "joint"),
    [
        (["MIT OR Apache-2.0"], "MIT OR Apache-2.0"),
        (["A AND B", "A"], "A AND B"),
        (["MIT OR X", "B"], "(MIT OR X) AND B"),
        (["(MIT OR X) AND B", "MIT OR X", "B"], "(MIT OR X) AND B"),
        (["A AND B OR C", "D"], "(A AND B OR C) AND D"),
        (["GPL WITH Exception AND B", "B"], "B AND GPL WITH Exception"),
        (["Use, AND copy", "B"], "B AND Use, AND copy"),
    ],
)
def test_joined_licences_name_each_once_and_bind_as_given(licences, joint):
    assert export.joint_terms({"licence": one} for one in licences)["licence"] == joint


def test_a_creature_that_is_no_ancestor_is_refused():
    oldest, stranger = one(40), one(100)
    young = one(80, oldest)
    with pytest.raises(creature.CreatureError, match=r"`ancestors.1` needs an ancestor"):
        pedigree.split(pedigree.document(young, [oldest, stranger]))
    grown = one(80, one(60, oldest))
    with pytest.raises(creature.CreatureError, match=r"`ancestors.0` needs an ancestor"):
        pedigree.split(pedigree.document(grown, [oldest]))


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("parents", ["0" * 64] * 95_000),
        ("parents", ["0" * 64] * 257),
        ("operator", "x" * 201),
        ("generation", 2**53),
        ("seed", 2**32),
        ("version", "x" * 201),
    ],
)
def test_what_a_file_says_of_its_origin_has_bounds(part, value):
    assert refused(one(40), (("provenance", part), value)).field == f"provenance.{part}"


def test_a_creature_is_not_its_own_parent():
    file = one(40)
    error = refused(file, (("provenance", "parents"), [file["sha256"]]))
    assert error.field == "provenance.parents"
    assert "must be other creatures" in error.needed


def test_names_of_credit_are_words():
    file = one(40)
    assert creature.parse(file | {"credit": [" Ada "]})["credit"] == ["Ada"]
    for wrong in ([""], ["x" * 201], "Ada", [1]):
        with pytest.raises(creature.CreatureError, match="`credit"):
            creature.parse(file | {"credit": wrong})
