"""`python -m worker.self_test cpu|gpu [PARENT]`: whether the device computes, and rightly.

The supervisor runs it, in a process of its own, before it takes its first run, and when a job
has died before its first generation: else it could not tell a broken host from a run that no
host can carry out. It prints the kinds of device whose bits this one repeats, as JSON.
"""

import json
import signal
import sys

import numpy as np

from server.core.processes import die_with_parent

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


def main(needed: str, parent: str | None = None) -> None:
    """End with a sentence and status 1 if something is wrong; do not outlive the parent."""
    if parent:
        die_with_parent(int(parent), signal.SIGKILL)
    from microcosmos import device

    device.prepare()
    import jax

    found = jax.local_devices()[0].platform
    if needed == "gpu" and found == "cpu":
        sys.exit("JAX sees no GPU, and this worker had one")
    if wrong := fault(computed(), exact=bool(device.kernel_version()) and found == "cpu"):
        sys.exit(wrong)
    print(json.dumps([device.device_kind(), device.device_kind(portable=False)]))


def fault(displacements: list[float], exact: bool) -> str | None:
    """Return what is wrong with the numbers; None for the right ones."""
    tolerance = 0.0 if exact else TOLERANCE
    whole = len(displacements) == len(EXPECTED)
    if whole and np.allclose(displacements, EXPECTED, rtol=tolerance, atol=0.0):
        return None
    return f"it computes {displacements} instead of {list(EXPECTED)}"


def computed() -> list[float]:
    """Return what the creatures of the test achieve, in order of size."""
    from microcosmos.build import build
    from microcosmos.spec import parse

    experiment = build(parse(SPEC))
    _, report = experiment.advance(experiment.init())
    return sorted(elite.fitness for elite in report.elites)


if __name__ == "__main__":
    main(*sys.argv[1:])
