"""`python -m worker.self_test cpu|gpu [PARENT]`: whether the device computes, and rightly.

The supervisor runs it, in a process of its own, before it takes its first run, and when a job
has died before its first generation: else it could not tell a broken host from a run that no
host can carry out. It prints the kinds of device whose bits this one repeats, as JSON.
"""

import json
import signal
import sys
from typing import NoReturn

from server.core.processes import die_with_parent
from server.settings import Settings

from .device import NO_DEVICE


def main(needed: str, parent: str | None = None) -> None:
    """End with a sentence and a status if something is wrong; do not outlive the parent."""
    if parent:
        die_with_parent(int(parent), signal.SIGKILL)
    from microcosmos import device
    from microcosmos.doctor import self_test

    device.prepare()
    import jax

    try:
        found = jax.local_devices()[0].platform
    except (RuntimeError, AssertionError) as error:  # The driver is gone.
        _end_without_device(f"JAX finds no device ({error!r})")
    if needed == "gpu" and found == "cpu":
        _end_without_device("JAX sees no GPU, and this worker had one")
    if wrong := self_test.fault_here() or cluster_fault(Settings()):
        sys.exit(wrong)
    print(json.dumps([device.device_kind(), device.device_kind(portable=False)]))


def _end_without_device(text: str) -> NoReturn:
    print(text, file=sys.stderr)
    sys.exit(NO_DEVICE)


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
