"""Writes the archive file of a screened search.

`test_devices` runs it with the number of devices and the path of the file.
"""

import os
import sys
from pathlib import Path

from microcosmos.device import prepare

prepare(devices=int(sys.argv[1]), cache=os.environ["MICROCOSMOS_TEST_CACHE"])

from microcosmos.build import build  # noqa: E402
from microcosmos.spec import parse  # noqa: E402

SPEC = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"nodes": 8},
    "control": {"period": 20},
    "task": {"steps": 60},
    "search": {"generations": 6, "batch": 32, "block": 4}
    | {"screening": {"rounds": 2, "candidates": 5}},
}


def main() -> None:
    run = build(parse(SPEC))
    state = run.init()
    while not run.done(state):
        state, _ = run.advance(state)
    assert state.screened.model.ready
    Path(sys.argv[2]).write_bytes(run.save(state))


main()
