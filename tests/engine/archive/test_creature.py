"""A creature file from anybody is checked before it is believed."""

import copy
import json

import pytest

from microcosmos.archive import creature
from microcosmos.naming import encode

pytestmark = pytest.mark.fast

IDENTITY = {
    "format": "microcosmos-creature/1",
    "genome": {
        "encoding": "cppn",
        "inputs": ["position", "sine", "cosine"],
        "outputs": ["rest_angle", "rest_length"],
        "control": {},
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
    """A sound creature file, all defaults written out."""
    parsed = creature.Identity.model_validate(IDENTITY)
    return creature.document(parsed.model_dump(mode="json"), None, None)


def refused(file, change) -> creature.CreatureError:
    changed = copy.deepcopy(file)
    change(changed)
    with pytest.raises(creature.CreatureError) as caught:
        creature.parse(changed)
    return caught.value


def test_a_sound_file_comes_back_as_it_was(file):
    assert creature.parse(json.dumps(file)) == file


def test_the_name_does_not_depend_on_how_the_json_is_written(file):
    other = json.loads(json.dumps(file["identity"], indent=4, sort_keys=True))
    other["world"]["viscosity"] = 5e-2
    assert creature.name(other) == file["sha256"]


def test_a_changed_gene_is_noticed(file):
    def change(f):
        f["identity"]["genome"]["connections"]["weight"] = encode([1, -2, 0.25, 4])

    error = refused(file, change)
    assert error.field == "sha256"
    assert error.got == file["sha256"]


GENES = ("identity", "genome")


@pytest.mark.parametrize(
    ("field", "value", "where"),
    [
        ((*GENES, "nodes", "activation"), ["identity"] * 5 + ["step"], "activation"),
        ((*GENES, "nodes", "bias"), "AAAA", "bias"),
        ((*GENES, "nodes", "bias"), "not base64!", "bias"),
        ((*GENES, "nodes", "bias"), encode([0, 0, 0, float("nan"), 0, 0]), "bias"),
        ((*GENES, "nodes", "id"), [0, 1, 2, 3, 9, 4], "genome"),
        ((*GENES, "connections", "source"), [0, 1, 2, 77], "genome"),
        ((*GENES, "connections", "target"), [3, 4, 9, 0], "genome"),
        ((*GENES, "connections", "target"), [3, 4, 9, 9], "genome"),
        ((*GENES, "connections", "innovation"), [0, 4, 4, 8], "genome"),
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
def test_a_file_that_is_not_sound_is_refused_by_its_field(file, field, value, where):
    def change(f):
        *path, last = field
        for part in path:
            f = f[part]
        f[last] = value

    assert where in refused(file, change).field


def test_a_cycle_is_refused(file):
    def change(f):
        connections = f["identity"]["genome"]["connections"]
        connections["source"], connections["target"] = [0, 4, 9, 3], [3, 9, 4, 9]

    assert "free of cycles" in str(refused(file, change))


def test_text_that_is_no_json_is_a_value_error():
    with pytest.raises(creature.CreatureError, match="`file` needs JSON"):
        creature.parse("{")


def measured(**changes):
    measures = {"displacement": 2.0, "bending_effort": 0.5}
    whole = {
        "fitness": 2.0,
        "descriptors": {"bending_effort": 0.5},
        "measures": measures,
        "block": 16,
        "room": [8, 16],
        "device": "cpu",
    }
    return whole | changes


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
    assert "measured" in refused(file | {"measured": measured(**changes)}, dict).field


def test_room_for_fewer_genes_than_there_are_is_refused(file):
    ids = list(range(5)) + list(range(9, 13))
    nodes = file["identity"]["genome"]["nodes"]
    nodes["id"], nodes["activation"] = ids, ["identity"] * 9
    nodes["bias"] = encode([0] * 9)
    file["sha256"] = creature.name(file["identity"])
    assert creature.parse(file)
    assert "`measured.room` must be at least" in str(
        refused(file | {"measured": measured()}, dict)
    )
