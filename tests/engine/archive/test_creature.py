"""Creature files of every encoding and pedigree: parsed, checked and refused."""

import copy
import json
from functools import reduce
from operator import getitem

import numpy as np
import pytest

from microcosmos import spec
from microcosmos.archive import creature, pedigree
from microcosmos.build import identity_template
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


def test_a_cycle_is_refused(file):
    cycle = ((*LINKS, "source"), [0, 4, 9, 3]), ((*LINKS, "target"), [3, 9, 4, 9])
    assert "free of cycles" in str(refused(file, *cycle))


def test_text_that_is_no_json_is_a_value_error():
    with pytest.raises(creature.CreatureError, match="`file` needs JSON"):
        creature.parse("{")


def measured(**changes):
    figures = {"fitness": 2.0, "descriptors": {"bending_effort": 0.5}}
    figures["measures"] = {"speed": 2.0, "bending_effort": 0.5}
    return figures | {"block": 16, "room": [8, 16], "device": "cpu"} | changes


def test_a_measurement_is_kept(file):
    assert creature.parse(file | {"measured": measured()})["measured"]["fitness"] == 2


@pytest.mark.parametrize(
    "changes",
    [
        {"fitness": 3.0},
        {"descriptors": {"bending_effort": 0.6}},
        {"measures": {}},
        {"room": [-1, 16]},
        {"room": [10**30, 16]},
        {"block": 0},
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


VECTORS = [spec.Direct(bend=spec.Bounds(low=0.1, high=0.9)), spec.Weights(hidden=(4,))]


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


def test_a_network_that_grows_has_outputs_for_what_is_free():
    control = spec.Grown(wave_number=None, stretch=None, shear=None, bend=None)
    activation = ["identity"] * 3 + ["sin"] * 5
    nodes = {"id": list(range(8)), "activation": activation, "bias": encode(np.zeros(8))}
    links = NETWORK["connections"] | {"source": [0, 1, 2, 1], "target": [3, 4, 7, 5]}
    file = document(control, {"nodes": nodes, "connections": links})
    free = ["body_rest_angle", "body_rest_length", "growth"]
    assert file["identity"]["genome"]["outputs"][2:] == free
    assert creature.parse(file) == file
    assert creature.room(file) == (8, 8)
    file["identity"]["genome"]["outputs"].pop()
    with pytest.raises(creature.CreatureError, match="`outputs` must be"):
        creature.parse(file)


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


@pytest.mark.parametrize("licence", ["", "x" * 2_000_000])
def test_a_licence_is_a_line(licence):
    assert refused(one(40), (("licence",), licence)).field == "licence"


def test_names_and_devices_of_a_measurement_have_bounds(file):
    long = measured(device="x" * 1001)
    assert refused(file | {"measured": long}).field == "measured.device"
    measures = measured()["measures"] | {"x" * 201: 1.0}
    wrong = refused(file | {"measured": measured(measures=measures)}).field
    assert wrong.startswith("measured.measures")


def test_names_of_credit_are_words():
    file = one(40)
    assert creature.parse(file | {"credit": [" Ada "]})["credit"] == ["Ada"]
    for wrong in ([""], ["x" * 201], ["x"] * 51, "Ada", [1]):
        with pytest.raises(creature.CreatureError, match="`credit"):
            creature.parse(file | {"credit": wrong})
