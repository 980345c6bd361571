"""Check Python, packages, memory, JAX, its devices and the compile cache."""

import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Any, Literal

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.version import Version

from ..sizes import size
from ..spec import EXPERIMENTS, estimate
from ..version import VERSION

Level = Literal["ok", "warning", "problem"]


@dataclass(frozen=True)
class Finding:
    """The result of a check; only an `ok` has no `advice`."""

    subject: str
    level: Level
    found: str
    advice: str | None = None

    def __post_init__(self) -> None:
        assert (self.advice is None) == (self.level == "ok")


def ok(subject: str, found: str) -> Finding:
    return Finding(subject, "ok", found)


def warning(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "warning", found, advice)


def problem(subject: str, found: str, advice: str) -> Finding:
    return Finding(subject, "problem", found, advice)


def python() -> Iterator[Finding]:
    text = f"{platform.python_version()} on {platform.machine()} {platform.system()}"
    # As `requires-python` in pyproject.toml.
    if (3, 11) <= sys.version_info[:2] < (3, 13):
        yield ok("Python", text)
    else:
        yield problem("Python", text, "install Python 3.11 or 3.12: make PYTHON=python3.12")


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
        installed = version(needed.name)
    except PackageNotFoundError:
        return None if needed.marker else f"{text} and not installed"
    return (
        None if satisfied(installed, needed.specifier) else f"{text}; {installed} is installed"
    )


def satisfied(installed: str, needed: SpecifierSet) -> bool:
    """Return whether a version is within bounds; a pre-release counts as its release."""
    return Version(installed).base_version in needed


MEMINFO = Path("/proc/meminfo")
CONTROL_GROUP = Path("/sys/fs/cgroup")
"""Root of control groups, version 2; in a container, its own group."""
MIN_BYTES = 2 << 30
"""Bytes that JAX, its compiler and a small run need."""


def memory(meminfo: Path = MEMINFO, group: Path = CONTROL_GROUP) -> Iterator[Finding]:
    """Check the available memory, and list the presets that need more than there is."""
    whole, free = memory_bytes(meminfo, group)
    text = f"{size(free)} of {size(whole)} available"
    if free < MIN_BYTES:
        advice = "end other programs, or run fewer workers: make run WORKERS=1"
        yield warning("memory", text, advice)
    else:
        yield ok("memory", text)
    for experiment in EXPERIMENTS.values():
        for preset in experiment.presets:
            needed = estimate(preset.spec).memory_bytes
            if needed > whole:
                text = f"the preset {experiment.name}/{preset.name} needs {size(needed)}"
                yield warning("memory", text, "use a smaller block, or a larger machine")


def memory_bytes(meminfo: Path = MEMINFO, group: Path = CONTROL_GROUP) -> tuple[int, int]:
    """Return total and available bytes of the machine, or of the container around us."""
    if meminfo.exists():
        kibibytes = _numbers(meminfo)
        whole, free = 1024 * kibibytes["MemTotal:"], 1024 * kibibytes["MemAvailable:"]
    else:
        # Systems without /proc tell the memory, but not how much of it is free.
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


PATIENCE = 120.0
"""Seconds; a healthy driver needs a few."""
USE_CPU = "JAX_PLATFORMS=cpu leaves the GPU out"


def devices(cache: Path, patience: float = PATIENCE) -> Iterator[Finding]:
    """Check JAX, each device, and that compiled programs are stored and loaded again."""
    yield from _folder(cache)
    try:
        probe = probed(cache, patience)
    except subprocess.TimeoutExpired:
        text = f"JAX did not answer within {patience:.0f} s: a driver hangs"
        advice = f"look at nvidia-smi, restart the machine; until then {USE_CPU}"
        yield problem("devices", text, advice)
        return
    except RuntimeError as error:
        yield problem("devices", f"JAX fails: {error}", f"make install; {USE_CPU}")
        return
    if "refused" in probe:
        advice = "correct or unset the variable; if none is named, make install"
        yield problem("native kernel", probe["refused"], advice)
        return
    yield from _devices(probe)
    yield _kernel(probe["kernel"], probe["devices"])
    program = probe["cache"]
    if program["stored"] and program["loaded"]:
        yield ok("compile cache", "a stored program is loaded again")
        return
    text = f"a compiled program is not {'loaded again' if program['stored'] else 'stored'}"
    other = "choose another folder with JAX_COMPILATION_CACHE_DIR"
    yield warning(
        "compile cache", text, f"each start compiles anew; remove {cache}, or {other}"
    )


def probed(cache: Path, patience: float) -> dict[str, Any]:
    """Run the probe; raise `RuntimeError` with its last line if it fails."""
    command = [sys.executable, "-m", "microcosmos.doctor.probe", str(cache)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=patience)
    if done.returncode:
        words = done.stderr.strip().splitlines()
        raise RuntimeError(words[-1][:300] if words else f"it ended with {done.returncode}")
    # Libraries may print lines before it.
    return json.loads(done.stdout.splitlines()[-1])


def _devices(probe: dict[str, Any]) -> Iterator[Finding]:
    for one in probe["devices"]:
        name = f"{one['platform']} {one['id']} ({one['model']})"
        if "error" in one:
            yield problem("devices", f"{name}: {one['error']}", USE_CPU)
        elif not one["correct"]:
            yield problem("devices", f"{name} computes wrong numbers", f"avoid it: {USE_CPU}")
        elif one["memory_bytes"]:
            free = one["memory_bytes"] - one["memory_used_bytes"]
            text = f"{name}: {size(free)} of {size(one['memory_bytes'])} free to JAX"
            yield ok("GPU memory", text)
    platforms = [one["platform"] for one in probe["devices"]]
    nvidia = Path("/proc/driver/nvidia").exists() or shutil.which("nvidia-smi")
    if set(platforms) == {"cpu"} and nvidia:
        yield warning(
            "devices",
            "there is an NVIDIA GPU, and JAX sees only the CPU",
            "install JAX's CUDA build: make install, or pip install 'microcosmos[cuda]'",
        )
    counted = ", ".join(f"{platforms.count(p)} × {p}" for p in dict.fromkeys(platforms))
    yield ok("devices", f"{counted}: {probe['kind']}")


def _kernel(kernel: dict[str, Any], devices: list[dict[str, Any]]) -> Finding:
    if kernel["version"]:
        return ok("native kernel", f"version {kernel['version']} simulates what it covers")
    if kernel["chosen"] == "jax":
        return ok("native kernel", "MICROCOSMOS_KERNEL leaves it out: JAX simulates")
    if any(one["platform"] != "cpu" for one in devices):
        text = "the GPU has a kernel of its own; it needs blocks of 256 creatures to be busy"
        return ok("native kernel", text)
    return warning(
        "native kernel",
        "it is not installed: JAX simulates, several times slower",
        "make install, on a machine with a C++ compiler or the package registry",
    )


def _folder(cache: Path) -> Iterator[Finding]:
    """Check the folder of compiled programs; make it if it is missing."""
    advice = f"make it writable (chown, chmod {cache}), or set JAX_COMPILATION_CACHE_DIR"
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        yield problem("compile cache", f"{cache}: {error.strerror}", advice)
        return
    files = [path.stat().st_size for path in cache.rglob("*") if path.is_file()]
    yield ok("compile cache", f"{len(files)} files, {size(sum(files))} in {cache}")
    if not os.access(cache, os.W_OK):
        yield problem("compile cache", f"{cache} cannot be written to", advice)
