"""The CPU of this machine: its model, and the threads of each worker."""

import os
import platform
from collections.abc import Sequence
from pathlib import Path

CPUINFO = Path("/proc/cpuinfo")
TOPOLOGY = Path("/sys/devices/system/cpu")


def model() -> str:
    """Return the processor's model, else its instruction set."""
    lines = CPUINFO.read_text().splitlines() if CPUINFO.exists() else []
    fields = (line.partition(":") for line in lines)
    named = (value.strip() for name, _, value in fields if name.strip() == "model name")
    return next(named, "") or platform.processor() or platform.machine()


def threads() -> list[int]:
    """Return the threads that this process may use, ordered by socket and core."""
    if not hasattr(os, "sched_getaffinity"):
        return list(range(os.cpu_count() or 1))
    return sorted(os.sched_getaffinity(0), key=_place)


def share(given: Sequence[int], index: int, workers: int) -> list[int]:
    """Divide threads evenly among workers; they share if there are more workers."""
    if workers > len(given):
        return [given[index % len(given)]]
    return list(given[index * len(given) // workers : (index + 1) * len(given) // workers])


def pin(chosen: Sequence[int]) -> None:
    """Restrict this process and its children to these threads, if the system supports it."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, chosen)


def _place(thread: int) -> list[int]:
    topology = TOPOLOGY / f"cpu{thread}" / "topology"
    files = (topology / "physical_package_id", topology / "core_id")
    return [*(int(file.read_text()) if file.exists() else 0 for file in files), thread]
