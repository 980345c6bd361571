"""The one device that a worker computes on, found without starting it."""

import os
from dataclasses import dataclass
from pathlib import Path

import psutil

from . import nvidia, processor

FRACTION = "XLA_PYTHON_CLIENT_MEM_FRACTION"
TAKEN = 0.75
"""The part of a GPU's memory that JAX takes if it has the GPU alone."""


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
    """Return the device of the worker with this number: a GPU of its own if there are any.

    More workers than GPUs share them and their memory. Without a GPU each worker has its part
    of the processor's threads; no result depends on their number.
    """
    gpus = nvidia.visible()
    if not gpus:
        threads = processor.share(processor.threads(), index, workers)
        name = f"{processor.model()} ({len(threads)} threads)"
        return Device(name, memory(), {}, threads=tuple(threads))
    gpu = gpus[index % len(gpus)]
    sharing = max(1, len(range(index % len(gpus), workers, len(gpus))))
    environment = {"CUDA_VISIBLE_DEVICES": gpu.uuid}
    if sharing == 1:
        return Device(gpu.name, gpu.memory_bytes, environment, gpu.uuid)
    environment[FRACTION] = os.environ.get(FRACTION, f"{TAKEN / sharing:.3f}")
    name = f"{gpu.name} (shared by {sharing} workers)"
    return Device(name, gpu.memory_bytes // sharing, environment, gpu.uuid)


def memory() -> int:
    """Bytes of physical memory, or the control group's limit if that is less."""
    physical = psutil.virtual_memory().total
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        return min(physical, int(text))
    return physical
