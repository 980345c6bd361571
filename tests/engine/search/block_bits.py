"""Prints what one creature measures in several places of a block; run by `test_block`."""

import hashlib
import json
import os
import sys

from microcosmos.device import prepare

prepare(devices=int(sys.argv[1]), cache=os.environ["MICROCOSMOS_TEST_CACHE"])

import jax  # noqa: E402
import numpy as np  # noqa: E402

from microcosmos import search  # noqa: E402
from microcosmos.build import build_block, build_plan  # noqa: E402
from microcosmos.spec import parse  # noqa: E402

SPEC = parse(
    {
        "experiment": "quality-diversity",
        "world": {"width": 32, "height": 32},
        "body": {"nodes": 12},
        "control": {"period": 30},
        "task": {"steps": 150},
        "search": {"batch": 64, "block": 16},
    }
)


def bits(evaluation: search.Evaluation, slot: int) -> str:
    row = jax.tree.map(lambda x: np.asarray(x)[slot].tobytes(), evaluation)
    return hashlib.sha256(b"".join(jax.tree.leaves(row))).hexdigest()


def main() -> None:
    plan = build_plan(SPEC)
    program = build_block(SPEC.scene, plan.encoding.room)
    keys = jax.random.split(jax.random.key(0), 64)
    children = search.emitters.newcomers(plan.encoding.newcomer, keys)
    networks = jax.device_get(children.genotypes)

    def evaluate(order):
        chosen = jax.tree.map(lambda x: x[np.array(order)], networks)
        return search.evaluate_blocks(program, chosen, block=16)

    batch = evaluate(range(64))
    found = {
        "slot 0": bits(evaluate(range(5, 21)), 0),
        "slot 15": bits(evaluate(range(20, 4, -1)), 15),
        "among others": bits(evaluate([40, 50, 60, 5, 33, 22]), 3),
        "alone": bits(evaluate([5]), 0),
        "batch": [bits(batch, slot) for slot in range(64)],
    }
    assert found["batch"][5] == found["alone"]
    print(json.dumps(found))


main()
