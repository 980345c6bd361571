"""Creatures of every encoding are replayed, repeated bit for bit, and audited."""

import jax
import numpy as np
import pytest

from microcosmos import genomes, search, spec
from microcosmos.archive import creature
from microcosmos.audit.physics import audit
from microcosmos.audit.reproducibility import check
from microcosmos.build import build_block, build_encoding, frame
from microcosmos.device import device_kind
from microcosmos.experiments.lineage import identity
from microcosmos.viz.replay import record
from microcosmos.viz.replay_file import read_replay

NODES, STEPS, ROOM = 8, 24, (16, 32)
BASE = {"period": 12, "angle_scale": 0.3}
BENT = spec.Bounds(low=-0.1, high=0.1)


def controls():
    return {
        "recurrent": spec.Control(recurrent=True, **BASE),
        "direct": spec.Direct(rest_angle=BENT, bend=spec.Bounds(low=0.3, high=1.0), **BASE),
        "weights": spec.Weights(**BASE),
        "cppn-body": spec.Grown(**BASE),
    }


@pytest.fixture(params=list(controls()))
def file(request):
    """A creature that was measured as those of a run are."""
    scene = spec.Scene(
        world=spec.World(width=20, height=20),
        body=spec.Chain(nodes=NODES),
        control=controls()[request.param],
        task=spec.Task(steps=STEPS),
    )
    encoding = build_encoding(scene, ROOM)
    genotype = jax.device_get(encoding.newcomer(key=jax.random.key(7)))
    alone = jax.tree.map(lambda x: np.asarray(x)[None], genotype)
    found = search.evaluate_blocks(build_block(scene, ROOM), alone, block=2)
    assert found.status[0] == 0
    measures = dict(zip(search.MEASURES, found.measures[0].tolist(), strict=True))
    measured = {
        "fitness": float(found.fitness[0]),
        "descriptors": {name: measures[name] for name in ("hidden_nodes", "symmetry")},
        "measures": measures,
        "block": 2,
        "room": list(ROOM) if encoding.room else None,
        "device": device_kind(),
    }
    one = genomes.take(alone, 0)
    return creature.document(identity(frame(scene), one), measured, None)


@pytest.mark.optimised
def test_a_creature_of_any_encoding_is_repeated_bit_for_bit(file):
    assert check(file).exact


@pytest.mark.long
def test_a_creature_of_any_encoding_is_watched_and_audited(file):
    replay = read_replay(record(file))
    nodes = int(file["measured"]["measures"]["nodes"])
    assert replay.header["nodes"] == nodes <= NODES
    assert replay.header["edges"] == [[i, i + 1] for i in range(nodes - 1)]
    recorded = file["measured"]["fitness"]
    np.testing.assert_allclose(replay.header["fitness"]["replayed"], recorded, rtol=1e-2)
    assert set(replay.header["descriptors"]["replayed"]) == {"hidden_nodes", "symmetry"}
    found = {row["name"]: row["value"] for row in audit(file)["rows"]}
    np.testing.assert_allclose(found["displacement"], recorded, rtol=1e-2)
    assert all(found[name] is not None for name in ("refined", "delta", "reciprocal"))
