"""The processor of this machine: its model, and which of its threads a worker has."""

import os
import platform
from collections.abc import Sequence
from pathlib import Path

INFORMATION = Path("/proc/cpuinfo")
TOPOLOGY = Path("/sys/devices/system/cpu")


def model() -> str:
    """The processor's model as the system tells it, else its instruction set."""
    lines = INFORMATION.read_text().splitlines() if INFORMATION.exists() else []
    fields = (line.partition(":") for line in lines)
    named = (value.strip() for name, _, value in fields if name.strip() == "model name")
    return next(named, "") or platform.processor() or platform.machine()


def threads() -> list[int]:
    """Those that we may use, neighbours on a core or a socket beside each other."""
    if not hasattr(os, "sched_getaffinity"):
        return list(range(os.cpu_count() or 1))
    return sorted(os.sched_getaffinity(0), key=_place)


def share(given: Sequence[int], index: int, workers: int) -> list[int]:
    """The threads of one worker of several: all are given out, evenly, none twice.

    With more workers than threads, some have to share.
    """
    if workers > len(given):
        return [given[index % len(given)]]
    return list(given[index * len(given) // workers : (index + 1) * len(given) // workers])


def keep_to(chosen: Sequence[int]) -> None:
    """Have this process and its children use these threads alone, where the system can."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, chosen)


def _place(thread: int) -> tuple[int, int, int]:
    """Socket and core of a thread, and itself."""
    topology = TOPOLOGY / f"cpu{thread}" / "topology"

    def number(name: str) -> int:
        file = topology / name
        return int(file.read_text()) if file.exists() else 0

    return number("physical_package_id"), number("core_id"), thread
