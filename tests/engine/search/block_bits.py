"""Prints what one creature measures in several places of a block; run by `test_block` with the
number of devices and the kind of body."""

import hashlib
import json
import os
import sys

from microcosmos.device import prepare

prepare(devices=int(sys.argv[1]), cache=os.environ["MICROCOSMOS_TEST_CACHE"])

import jax  # noqa: E402
import numpy as np  # noqa: E402

from microcosmos import search  # noqa: E402
from microcosmos.build import build_block, build_encoding  # noqa: E402
from microcosmos.spec import parse  # noqa: E402

SMALL = {
    "experiment": "quality-diversity",
    "world": {"width": 32, "height": 32},
    "task": {"steps": 60},
    "search": {"batch": 32, "block": 8},
}
KINDS = {
    "chain": {"body": {"nodes": 12}, "control": {"period": 30}},
    "grown": {
        "body": {"builder": "grown", "nodes": 20, "length": 16.0, "segments": 6},
        "control": {"encoding": "body-graph", "period": 30, "softest": 0.5},
    },
}
SPEC = parse(SMALL | KINDS[sys.argv[2]])


def bits(evaluation: search.Evaluation, slot: int) -> str:
    row = jax.tree.map(lambda x: np.asarray(x)[slot].tobytes(), evaluation)
    return hashlib.sha256(b"".join(jax.tree.leaves(row))).hexdigest()


def main() -> None:
    room = (SPEC.genome.max_nodes, SPEC.genome.max_connections)
    encoding = build_encoding(SPEC.scene, room)
    program = build_block(SPEC.scene, encoding.room)
    keys = jax.random.split(jax.random.key(0), 32)
    children = search.emitters.newcomers(encoding.newcomer, keys)
    networks = jax.device_get(children.genotypes)

    def evaluate(order):
        chosen = jax.tree.map(lambda x: x[np.array(order)], networks)
        return search.evaluate_blocks(program, chosen, block=8)

    batch = evaluate(range(32))
    found = {
        "first slot": bits(evaluate(range(5, 13)), 0),
        "last slot": bits(evaluate(range(12, 4, -1)), 7),
        "among others": bits(evaluate([20, 25, 30, 5, 17, 11]), 3),
        "alone": bits(evaluate([5]), 0),
        "batch": [bits(batch, slot) for slot in range(32)],
    }
    assert found["batch"][5] == found["alone"]
    print(json.dumps(found))


main()
