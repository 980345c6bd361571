"""The one device that a worker computes on, a GPU or CPU threads, found without starting it."""

import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import psutil

from . import nvidia

CPUINFO = Path("/proc/cpuinfo")
TOPOLOGY = Path("/sys/devices/system/cpu")
MEMORY_FRACTION = "XLA_PYTHON_CLIENT_MEM_FRACTION"
NO_DEVICE = 3
"""Exit status of a self-test that finds no device of the needed kind; 1 for other faults."""
DEFAULT_FRACTION = 0.75
"""Fraction of a GPU's memory that JAX allocates by default."""


@dataclass(frozen=True)
class Device:
    """A worker's device, and the settings with which its job processes use it."""

    name: str
    memory_bytes: int
    environment: dict[str, str]
    gpu: str | None = None
    """UUID of the GPU; None if the device is the machine's processor."""
    threads: tuple[int, ...] = ()
    """Threads of the processor, if that is the device."""


def find(index: int, workers: int = 1) -> Device:
    """Return the device of the worker with this number: a GPU, if there is any.

    If there are more workers than GPUs, they share the GPUs and their memory. Without a GPU,
    the workers divide the CPU threads; no result depends on the number of threads.
    """
    gpus = nvidia.visible()
    if not gpus:
        mine = share_threads(threads(), index, workers)
        name = f"{cpu_model()} ({len(mine)} threads)"
        return Device(name, memory(), {}, threads=tuple(mine))
    gpu = gpus[index % len(gpus)]
    sharing = max(1, len(range(index % len(gpus), workers, len(gpus))))
    environment = {"CUDA_VISIBLE_DEVICES": gpu.uuid}
    if sharing == 1:
        return Device(gpu.name, gpu.memory_bytes, environment, gpu.uuid)
    fraction = f"{DEFAULT_FRACTION / sharing:.3f}"
    environment[MEMORY_FRACTION] = os.environ.get(MEMORY_FRACTION, fraction)
    name = f"{gpu.name} (shared by {sharing} workers)"
    return Device(name, gpu.memory_bytes // sharing, environment, gpu.uuid)


def memory() -> int:
    """Return the bytes of physical memory, or the control group's limit if that is less."""
    physical = psutil.virtual_memory().total
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        return min(physical, int(text))
    return physical


def cpu_model() -> str:
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


def share_threads(given: Sequence[int], index: int, workers: int) -> list[int]:
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
