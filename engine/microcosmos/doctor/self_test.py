"""Self-test: check that the device of this process computes creatures correctly."""

import jax
import numpy as np

from .. import device
from ..build import build
from ..spec import parse

EXPECTED = (
    *(0.022617654874920845, 0.028640512377023697, 0.0630212351679802, 0.0798707902431488),
    *(0.12764394283294678, 0.1588553488254547, 0.2046380490064621, 0.2556985318660736),
)
"""Displacements of the eight creatures of `SPEC` in cells. The native kernel gives these very
bits on every processor; what JAX finds differs by rounding. If the kernel, NEAT or its draws
have changed on purpose, these are what the test says that it computes."""
TOLERANCE = 1e-2
SPEC = {
    "experiment": "quality-diversity",
    "seed": 7,
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60, "fitness": "displacement"},
    "search": {"generations": 1, "batch": 8, "block": 8},
}


def fault_here() -> str | None:
    """Return the fault of the device of this process; None if it computes correctly."""
    on_cpu = jax.local_devices()[0].platform == "cpu"
    return fault(computed(), exact=bool(device.kernel_version()) and on_cpu)


def fault(displacements: list[float], exact: bool) -> str | None:
    """Return the fault of the displacements; None if they are as expected."""
    tolerance = 0.0 if exact else TOLERANCE
    whole = len(displacements) == len(EXPECTED)
    if whole and np.allclose(displacements, EXPECTED, rtol=tolerance, atol=0.0):
        return None
    return f"it computes {displacements} instead of {list(EXPECTED)}"


def computed() -> list[float]:
    """Return the displacements of the test's creatures in cells, in order of size."""
    experiment = build(parse(SPEC))
    _, report = experiment.advance(experiment.init())
    return sorted(elite.fitness for elite in report.elites)
