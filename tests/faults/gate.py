"""A plug-in measure that waits where a test says so: in the middle of a block.

It waits while GATE/hold-all or GATE/hold-NAME is there, where GATE_NAME holds the name, and
makes GATE/held-NAME meanwhile. GATE/used-NAME says that it computed at all.
"""

import os
import time
from pathlib import Path

import jax
import numpy as np

from microcosmos import plugins

SECONDS = float(os.environ.get("GATE_SECONDS", "0"))
"""Time that each creature takes more."""


def wait(value):
    folder, name = Path(os.environ["GATE"]), os.environ.get("GATE_NAME", "here")
    (folder / f"used-{name}").touch()
    time.sleep(SECONDS)
    while any((folder / f"hold-{one}").exists() for one in ("all", name)):
        (folder / f"held-{name}").touch()
        time.sleep(0.02)
    (folder / f"held-{name}").unlink(missing_ok=True)
    return np.float32(value)


@plugins.descriptor("wait", title="Displacement after a wait", low=0, high=3, unit="cells")
def displacement(motion):
    shape = jax.ShapeDtypeStruct((), np.float32)
    return jax.pure_callback(
        wait, shape, motion.measures["displacement"], vmap_method="sequential"
    )
