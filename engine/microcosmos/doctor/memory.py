"""Check the memory of the machine against the needs of presets."""

import os
from collections.abc import Iterator
from pathlib import Path

from ..sizes import size
from ..spec import EXPERIMENTS, estimate
from .finding import Finding, ok, warning

MEMINFO = Path("/proc/meminfo")
LIMIT = Path("/sys/fs/cgroup/memory.max")
MIN_BYTES = 2 << 30
"""Bytes that JAX, its compiler and a small run need."""


def memory(meminfo: Path = MEMINFO, limit: Path = LIMIT) -> Iterator[Finding]:
    """Check the available memory, and list the presets that need more than there is."""
    whole, free = memory_bytes(meminfo, limit)
    found = f"{size(free)} of {size(whole)} available"
    if free < MIN_BYTES:
        advice = "end other programs, or run fewer workers: make run WORKERS=1"
        yield warning("memory", found, advice)
    else:
        yield ok("memory", found)
    for experiment in EXPERIMENTS.values():
        for preset in experiment.presets:
            needed = estimate(preset.spec).memory_bytes
            if needed > whole:
                found = f"the preset {experiment.name}/{preset.name} needs {size(needed)}"
                yield warning("memory", found, "use a smaller block, or a larger machine")


def memory_bytes(meminfo: Path = MEMINFO, limit: Path = LIMIT) -> tuple[int, int]:
    """Return total and available bytes of the machine, or of the container around us."""
    if meminfo.exists():
        lines = (line.partition(":") for line in meminfo.read_text().splitlines())
        kibibytes = {name: int(rest.split()[0]) for name, _, rest in lines if rest.split()}
        whole, free = 1024 * kibibytes["MemTotal"], 1024 * kibibytes["MemAvailable"]
    else:
        whole = free = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        whole, free = min(whole, int(text)), min(free, int(text))
    return whole, free
