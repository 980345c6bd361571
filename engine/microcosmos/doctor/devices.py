"""The devices that compute, and the compile cache, as a process of its own finds them."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .finding import Finding, gib, ok, problem, warning

PATIENCE = 120.0
"""Seconds; a driver that is well needs a few."""
CPU = "JAX_PLATFORMS=cpu leaves the GPU out"


def devices(cache: Path, patience: float = PATIENCE) -> Iterator[Finding]:
    """JAX, each device, and whether compiled programs are kept and found."""
    yield from _folder(cache)
    try:
        found = probed(cache, patience)
    except subprocess.TimeoutExpired:
        yield problem(
            "devices",
            f"JAX did not answer within {patience:.0f} s: a driver hangs",
            f"look at nvidia-smi, restart the machine; until then {CPU}",
        )
        return
    except RuntimeError as error:
        yield problem("devices", f"JAX fails: {error}", f"make install; {CPU}")
        return
    yield from _devices(found)
    yield from _works(found["cache"], cache)


def probed(cache: Path, patience: float) -> dict[str, Any]:
    """What the probe tells; `RuntimeError` with its last words where it fails."""
    command = [sys.executable, "-m", "microcosmos.doctor.probe", str(cache)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=patience)
    if done.returncode:
        words = done.stderr.strip().splitlines()
        raise RuntimeError(words[-1][:300] if words else f"it ended with {done.returncode}")
    return json.loads(done.stdout.splitlines()[-1])


def _devices(found: dict[str, Any]) -> Iterator[Finding]:
    for one in found["devices"]:
        name = f"{one['platform']} {one['id']}"
        if "error" in one:
            yield problem("devices", f"{name} ({one['model']}): {one['error']}", CPU)
        elif not one["right"]:
            broken = f"{name} ({one['model']}) computes wrong numbers"
            yield problem("devices", broken, f"do not use it: {CPU}")
        elif one["memory_bytes"]:
            free = one["memory_bytes"] - one["memory_used_bytes"]
            told = f"{gib(free)} of {gib(one['memory_bytes'])} free to JAX"
            yield ok("GPU memory", f"{name} ({one['model']}): {told}")
    platforms = [one["platform"] for one in found["devices"]]
    if set(platforms) == {"cpu"} and _nvidia():
        yield warning(
            "devices",
            "there is an NVIDIA GPU, and JAX sees only the CPU",
            "install JAX's CUDA build: make install, or pip install 'microcosmos[cuda]'",
        )
    counted = ", ".join(f"{platforms.count(p)} × {p}" for p in dict.fromkeys(platforms))
    yield ok("devices", f"{counted}: {found['kind']}")


def _nvidia() -> bool:
    return Path("/proc/driver/nvidia").exists() or shutil.which("nvidia-smi") is not None


def _folder(cache: Path) -> Iterator[Finding]:
    """The folder of compiled programs, made where it is missing."""
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        yield problem("compile cache", f"{cache}: {error.strerror}", _advice(cache))
        return
    files = [path.stat().st_size for path in cache.rglob("*") if path.is_file()]
    yield ok("compile cache", f"{len(files)} files, {gib(sum(files))} in {cache}")
    if not os.access(cache, os.W_OK):
        yield problem("compile cache", f"{cache} cannot be written to", _advice(cache))


def _works(found: dict[str, bool], cache: Path) -> Iterator[Finding]:
    if found["kept"] and found["found"]:
        yield ok("compile cache", "a program that was kept is found again")
        return
    what = "is not found again" if found["kept"] else "is not kept"
    yield warning(
        "compile cache",
        f"a compiled program {what}",
        f"every start will compile anew; remove {cache}, or choose another folder with "
        "JAX_COMPILATION_CACHE_DIR",
    )


def _advice(cache: Path) -> str:
    return f"let it be written to (chown, chmod {cache}), or set JAX_COMPILATION_CACHE_DIR"
