"""Creature files of every encoding come back as they were; malformed ones are refused."""

import copy

import numpy as np
import pytest

from microcosmos import spec
from microcosmos.archive import creature
from microcosmos.build import frame
from microcosmos.naming import encode

pytestmark = pytest.mark.fast

NETWORK = {
    "nodes": {
        "id": [0, 1, 2, 3, 4, 9],
        "activation": ["identity"] * 3 + ["sin", "tanh", "gaussian"],
        "bias": encode([0, 0, 0, 0.5, -1, 2]),
    },
    "connections": {
        "innovation": [0, 4, 7, 8],
        "source": [0, 1, 9, 9],
        "target": [3, 4, 9, 4],
        "enabled": [True, True, True, True],
        "weight": encode([1, -2, 0.25, 3]),
    },
}


def document(control, genes):
    scene = spec.Scene(body=spec.Chain(nodes=6), control=control)
    whole = frame(scene)
    whole["genome"] |= genes
    return creature.document(whole, None, None)


def values(control):
    count = spec.gene_count(control, spec.shape(spec.Chain(nodes=6)))
    return {"values": encode(np.linspace(-1, 1, count))}


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
    wide = values(control)
    wide["values"] = encode(
        np.full(spec.gene_count(control, spec.shape(spec.Chain(nodes=6))), 1.5)
    )
    with pytest.raises(creature.CreatureError, match="-1 to 1") as caught:
        creature.parse(document(control, wide))
    assert caught.value.field == "identity.genome.values"


def test_only_recurrent_networks_have_cycles():
    file = document(spec.Control(recurrent=True), NETWORK)
    assert creature.parse(file) == file
    with pytest.raises(creature.CreatureError, match="free of cycles"):
        creature.parse(document(spec.Control(), NETWORK))


def test_a_network_that_grows_has_outputs_for_what_is_free():
    control = spec.Grown(stretch=None, shear=None, bend=None)
    genes = copy.deepcopy(NETWORK)
    genes["nodes"]["id"] = [0, 1, 2, 3, 4, 5, 6, 7]
    genes["nodes"]["activation"] = ["identity"] * 3 + ["sin"] * 5
    genes["nodes"]["bias"] = encode(np.zeros(8))
    genes["connections"] |= {"source": [0, 1, 2, 1], "target": [3, 4, 7, 5]}
    file = document(control, genes)
    assert file["identity"]["genome"]["outputs"][2:] == [
        "body_rest_angle",
        "body_rest_length",
        "growth",
    ]
    assert creature.parse(file) == file
    assert creature.room(file) == (8, 8)
    file["identity"]["genome"]["outputs"].pop()
    with pytest.raises(creature.CreatureError, match="`outputs` must be"):
        creature.parse(file)
