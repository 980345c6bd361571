"""The one device that a worker computes on, found without starting it."""

import os
from dataclasses import dataclass
from pathlib import Path

from . import nvidia, processor
from .nvidia import MIB as MIB

FRACTION = "XLA_PYTHON_CLIENT_MEM_FRACTION"
TAKEN = 0.75
"""The part of a GPU's memory that JAX takes where it has it alone."""


@dataclass(frozen=True)
class Device:
    """What a worker reports about itself, and how its job processes are told to use it."""

    name: str
    memory_bytes: int
    environment: dict[str, str]
    gpu: str | None = None
    """As `nvidia-smi -i` takes it; None where it is the machine's processor."""
    threads: tuple[int, ...] = ()
    """Of the processor, where that is the device."""


def find(index: int, workers: int = 1) -> Device:
    """The device of the worker with this number: a GPU of its own where there are any.

    More workers than GPUs share them and their memory. Without a GPU each worker has its part
    of the processor's threads; no result depends on how many those are.
    """
    gpus = nvidia.visible()
    if gpus:
        return _gpu(gpus[index % len(gpus)], _sharing(index, workers, len(gpus)))
    threads = processor.share(processor.threads(), index, workers)
    name = f"{processor.model()} ({len(threads)} threads)"
    return Device(name, memory(), {}, threads=tuple(threads))


def _sharing(index: int, workers: int, devices: int) -> int:
    """How many workers have the same device as this one."""
    return max(1, len(range(index % devices, workers, devices)))


def _gpu(gpu: nvidia.Gpu, sharing: int) -> Device:
    environment = {"CUDA_VISIBLE_DEVICES": gpu.uuid}
    if sharing == 1:
        return Device(gpu.name, gpu.memory_bytes, environment, gpu.uuid)
    part = {FRACTION: os.environ.get(FRACTION, f"{TAKEN / sharing:.3f}")}
    name = f"{gpu.name} (shared by {sharing} workers)"
    return Device(name, gpu.memory_bytes // sharing, environment | part, gpu.uuid)


def memory() -> int:
    """Bytes of physical memory, or the control group's limit where that is less."""
    physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        return min(physical, int(text))
    return physical
