"""The one device that a worker computes on, found without starting it."""

import os
from dataclasses import dataclass
from pathlib import Path

import psutil

from . import cpu, nvidia

MEMORY_FRACTION = "XLA_PYTHON_CLIENT_MEM_FRACTION"
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
        threads = cpu.share(cpu.threads(), index, workers)
        name = f"{cpu.model()} ({len(threads)} threads)"
        return Device(name, memory(), {}, threads=tuple(threads))
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
