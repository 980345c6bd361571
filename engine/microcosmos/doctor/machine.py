"""Check Python, the installed packages and the memory of the machine."""

import os
import platform
import sys
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from ..sizes import size
from ..spec import EXPERIMENTS, estimate
from ..version import VERSION
from .finding import Finding, ok, problem, warning


def python() -> Iterator[Finding]:
    found = f"{platform.python_version()} on {platform.machine()} {platform.system()}"
    if (3, 11) <= sys.version_info[:2] < (3, 13):
        yield ok("Python", found)
    else:
        yield problem("Python", found, "install Python 3.11 or 3.12: make PYTHON=python3.12")


def packages() -> Iterator[Finding]:
    """Compare the installed packages with the requirements of this version."""
    yield ok("Microcosmos", VERSION)
    try:
        needed = requires("microcosmos") or []
    except PackageNotFoundError:
        advice = "pip install . in its folder"
        yield warning("packages", "microcosmos itself is not installed", advice)
        return
    faults = list(filter(None, map(_fault, map(Requirement, needed))))
    for fault in faults:
        yield problem("packages", fault, "make install, or pip install --upgrade")
    if not faults:
        names = ("jax", "jaxlib", "equinox", "h5py")
        yield ok("packages", ", ".join(f"{name} {version(name)}" for name in names))


def _fault(needed: Requirement) -> str | None:
    """Name a violated requirement; a package of an extra may be absent, but not old."""
    text = f"{needed.name}{needed.specifier} is needed"
    try:
        found = version(needed.name)
    except PackageNotFoundError:
        return None if needed.marker else f"{text} and not installed"
    return None if satisfied(found, needed.specifier) else f"{text}; {found} is installed"


def satisfied(found: str, needed: SpecifierSet) -> bool:
    """Return whether a version is within bounds; a pre-release counts as its release."""
    return Version(found).base_version in needed


MEMINFO = Path("/proc/meminfo")
CONTROL_GROUP = Path("/sys/fs/cgroup")
"""Root of control groups, version 2; in a container, its own group."""
MIN_BYTES = 2 << 30
"""Bytes that JAX, its compiler and a small run need."""


def memory(meminfo: Path = MEMINFO, group: Path = CONTROL_GROUP) -> Iterator[Finding]:
    """Check the available memory, and list the presets that need more than there is."""
    whole, free = memory_bytes(meminfo, group)
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


def memory_bytes(meminfo: Path = MEMINFO, group: Path = CONTROL_GROUP) -> tuple[int, int]:
    """Return total and available bytes of the machine, or of the container around us."""
    if meminfo.exists():
        kibibytes = _numbers(meminfo)
        whole, free = 1024 * kibibytes["MemTotal:"], 1024 * kibibytes["MemAvailable:"]
    else:
        whole = free = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    limit = group / "memory.max"
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        # The kernel gives up cached files before a process runs out of memory.
        cached = _numbers(group / "memory.stat")["inactive_file"]
        used = int((group / "memory.current").read_text()) - cached
        whole, free = min(whole, int(text)), min(free, int(text) - used)
    return whole, free


def _numbers(table: Path) -> dict[str, int]:
    """Read the first number of each line, by name."""
    lines = map(str.split, table.read_text().splitlines())
    return {name: int(number) for name, number, *_ in lines}
