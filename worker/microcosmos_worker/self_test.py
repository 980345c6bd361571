"""`python -m microcosmos_worker.self_test cpu|gpu`: test a device against known bits.

The supervisor runs it, in a process of its own, before it takes its first run, and when a job
has died before its first generation: else it could not tell a broken host from a run that no
host can carry out. The last line of its output is JSON: the kinds of device whose bits this one
repeats or, with another status than 0, the problem.
"""

import json
import sys
from typing import NoReturn

from microcosmos_server.core.errors import first_line
from microcosmos_server.core.processes import end_with_parent
from microcosmos_server.settings import Settings

from .device import NO_DEVICE


def main(needed: str) -> None:
    """Print the kinds of device; end with a problem and a status if something is wrong."""
    end_with_parent()
    try:
        print(json.dumps(device_kinds(needed)))
    except Exception as error:
        _end(first_line(error), 1)


def device_kinds(needed: str) -> list[str]:
    """Return the kinds of device whose bits this one repeats; end the process if it fails."""
    from microcosmos import device
    from microcosmos.doctor import self_test

    device.prepare()
    import jax

    try:
        found = jax.local_devices()[0].platform
    except (RuntimeError, AssertionError) as error:  # The driver is gone.
        _end(f"JAX finds no device ({error!r})", NO_DEVICE)
    if needed == "gpu" and found == "cpu":
        _end("JAX sees no GPU, and this worker had one", NO_DEVICE)
    if wrong := self_test.fault_here() or cluster_fault(Settings()):
        _end(wrong, 1)
    return [device.device_kind(), device.device_kind(portable=False)]


def _end(problem: str, status: int) -> NoReturn:
    # The worker reads it from standard output: libraries write to standard error as they like.
    print(json.dumps(problem))
    sys.exit(status)


def cluster_fault(settings: Settings) -> str | None:
    """Return what is wrong with the address of the worker's cluster, if it has one."""
    from microcosmos.cluster import security

    if not settings.cluster:
        return None
    try:
        security(settings.cluster, settings.cluster_certificate)
    except (ValueError, ImportError) as error:
        return f"MICROCOSMOS_CLUSTER: {error}"
    return None


if __name__ == "__main__":
    main(*sys.argv[1:])
