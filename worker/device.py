"""The one device that a worker computes on, found without starting it."""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

QUERY = ("--query-gpu=name,memory.total", "--format=csv,noheader,nounits")
MIB = 1 << 20
NVIDIA_SECONDS = 20


@dataclass(frozen=True)
class Device:
    """What a worker reports about itself, and how its job processes are told to use it."""

    name: str
    memory_bytes: int
    environment: dict[str, str]
    gpu: str | None = None
    """As `nvidia-smi -i` takes it; None where it is the machine's processor."""


def find(index: int) -> Device:
    """The device of the worker with this number: a GPU where there are any, else the CPU."""
    gpus = nvidia()
    if not gpus:
        return Device(processor(), memory(), {})
    allowed = os.environ.get("CUDA_VISIBLE_DEVICES")
    names = allowed.split(",") if allowed else [str(i) for i in range(len(gpus))]
    chosen = names[index % len(names)]
    name, size = gpus[int(chosen)] if chosen.isdigit() else gpus[0]
    return Device(name, size, {"CUDA_VISIBLE_DEVICES": chosen}, chosen)


def nvidia() -> list[tuple[str, int]]:
    """Name and bytes of memory of every NVIDIA GPU that answers."""
    if os.environ.get("JAX_PLATFORMS") == "cpu" or not shutil.which("nvidia-smi"):
        return []
    try:
        answer = subprocess.run(
            ["nvidia-smi", *QUERY],
            check=False,
            capture_output=True,
            text=True,
            timeout=NVIDIA_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return []
    if answer.returncode:
        return []
    rows = [line.rsplit(",", 1) for line in answer.stdout.splitlines() if "," in line]
    return [(name.strip(), int(size) * MIB) for name, size in rows if size.strip().isdigit()]


def processor() -> str:
    """The processor's model and how many of its threads are ours."""
    threads = len(os.sched_getaffinity(0))
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return f"{line.partition(':')[2].strip()} ({threads} threads)"
    return f"{os.uname().machine} ({threads} threads)"


def memory() -> int:
    """Bytes of physical memory, or the control group's limit where that is less."""
    physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    limit = Path("/sys/fs/cgroup/memory.max")
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        return min(physical, int(text))
    return physical
