"""Check JAX, its devices and the compile cache, in a process of their own."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..sizes import size
from .finding import Finding, ok, problem, warning

PATIENCE = 120.0
"""Seconds; a healthy driver needs a few."""
USE_CPU = "JAX_PLATFORMS=cpu leaves the GPU out"


def devices(cache: Path, patience: float = PATIENCE) -> Iterator[Finding]:
    """Check JAX, each device, and that compiled programs are stored and loaded again."""
    yield from _folder(cache)
    try:
        found = probed(cache, patience)
    except subprocess.TimeoutExpired:
        text = f"JAX did not answer within {patience:.0f} s: a driver hangs"
        advice = f"look at nvidia-smi, restart the machine; until then {USE_CPU}"
        yield problem("devices", text, advice)
        return
    except RuntimeError as error:
        yield problem("devices", f"JAX fails: {error}", f"make install; {USE_CPU}")
        return
    yield from _devices(found)
    yield _kernel(found["kernel"], found["devices"])
    program = found["cache"]
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
    return json.loads(done.stdout.splitlines()[-1])


def _devices(found: dict[str, Any]) -> Iterator[Finding]:
    for one in found["devices"]:
        name = f"{one['platform']} {one['id']} ({one['model']})"
        if "error" in one:
            yield problem("devices", f"{name}: {one['error']}", USE_CPU)
        elif not one["correct"]:
            yield problem("devices", f"{name} computes wrong numbers", f"avoid it: {USE_CPU}")
        elif one["memory_bytes"]:
            free = one["memory_bytes"] - one["memory_used_bytes"]
            text = f"{name}: {size(free)} of {size(one['memory_bytes'])} free to JAX"
            yield ok("GPU memory", text)
    platforms = [one["platform"] for one in found["devices"]]
    nvidia = Path("/proc/driver/nvidia").exists() or shutil.which("nvidia-smi")
    if set(platforms) == {"cpu"} and nvidia:
        yield warning(
            "devices",
            "there is an NVIDIA GPU, and JAX sees only the CPU",
            "install JAX's CUDA build: make install, or pip install 'microcosmos[cuda]'",
        )
    counted = ", ".join(f"{platforms.count(p)} × {p}" for p in dict.fromkeys(platforms))
    yield ok("devices", f"{counted}: {found['kind']}")


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
