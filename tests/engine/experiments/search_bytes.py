"""Prints hashes of a search's files; run by `test_devices` with the number of devices and the
name of a spec."""

import hashlib
import json
import os
import sys

from microcosmos.device import prepare

prepare(devices=int(sys.argv[1]), cache=os.environ["MICROCOSMOS_TEST_CACHE"])

import jax  # noqa: E402

from microcosmos.build import build  # noqa: E402
from microcosmos.spec import parse  # noqa: E402


def main() -> None:
    experiment, found = build(parse(json.loads(sys.argv[2]))), []
    assert jax.local_device_count() == int(sys.argv[1])
    state = experiment.init()
    while not experiment.done(state):
        state, _ = experiment.advance(state)
        found.append(hashlib.sha256(experiment.save(state)).hexdigest())
    print(json.dumps(found))


main()
