"""The memory of the machine, against what presets need."""

import os
from collections.abc import Iterator
from pathlib import Path

from ..spec import EXPERIMENTS, estimate
from .finding import GIB, Finding, gib, ok, warning

MEMINFO = Path("/proc/meminfo")
LIMIT = Path("/sys/fs/cgroup/memory.max")
LEAST = 2 * GIB
"""JAX with its compiler and a small run."""


def memory(meminfo: Path = MEMINFO, limit: Path = LIMIT) -> Iterator[Finding]:
    """What there is, what is free, and which presets would not find room."""
    whole, free = there(meminfo, limit)
    found = f"{gib(free)} of {gib(whole)} available"
    if free < LEAST:
        yield warning(
            "memory", found, "end something else, or run fewer workers: make run WORKERS=1"
        )
    else:
        yield ok("memory", found)
    for name, needed in largest():
        if needed > whole:
            yield warning(
                "memory",
                f"the preset {name} needs {gib(needed)}",
                "give it a smaller block, or use a larger machine",
            )


def there(meminfo: Path, limit: Path) -> tuple[int, int]:
    """Bytes in all and available, of the machine or of the container that this is in."""
    if meminfo.exists():
        lines = (line.partition(":") for line in meminfo.read_text().splitlines())
        kibibytes = {name: int(rest.split()[0]) for name, _, rest in lines if rest.split()}
        whole, free = 1024 * kibibytes["MemTotal"], 1024 * kibibytes["MemAvailable"]
    else:
        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        free = whole
    if limit.exists() and (told := limit.read_text().strip()).isdigit():
        whole, free = min(whole, int(told)), min(free, int(told))
    return whole, free


def largest() -> list[tuple[str, int]]:
    """Presets with the bytes that they need."""
    return [
        (f"{experiment.name}/{preset.name}", estimate(preset.spec).memory_bytes)
        for experiment in EXPERIMENTS.values()
        for preset in experiment.presets
    ]
