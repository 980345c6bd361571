"""One search on this processor and on an emulated older one: the same bytes."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import rich
from drive import ROOT, Installation

TINY = {
    "experiment": "quality-diversity",
    "world": {"width": 24, "height": 24},
    "body": {"builder": "chain", "nodes": 10},
    "control": {"period": 60},
    "task": {"steps": 150},
    "search": {"generations": 3, "batch": 8},
}
EMULATED = ["qemu-x86_64", "-cpu", "SandyBridge"]
"""Runs a command on a processor that knows AVX, and neither AVX2 nor fused multiply-adds."""


def processors(product: Installation) -> bool:
    """Tell whether the processor's model changes nothing; emulation takes minutes."""
    if shutil.which(EMULATED[0]) is None:
        rich.print(f"NOT SHOWN: there is no {EMULATED[0]} (Debian's qemu-user)")
        return False
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        here = evolve(folder, "here", [])
        there = evolve(folder, "there", EMULATED)
    same = here == there
    rich.print(f"{EMULATED[-1]}: {len(here)} bytes {'identical' if same else 'DIFFERENT'}")
    return same


def evolve(folder: Path, name: str, emulated: list[str]) -> bytes:
    """Carry out the search in a process that compiles its programs itself."""
    spec, out = folder / "spec.json", folder / f"{name}.h5"
    spec.write_text(json.dumps(TINY))
    command = [sys.executable, Path(sys.executable).with_name("microcosmos"), "evolve", spec]
    environment = {n: v for n, v in os.environ.items() if n != "XLA_FLAGS"} | {
        "JAX_PLATFORMS": "cpu",
        "JAX_COMPILATION_CACHE_DIR": str(folder / name),
    }
    whole = [*emulated, *command, "--out", out]
    subprocess.run(whole, check=True, env=environment, cwd=ROOT, capture_output=True)
    return out.read_bytes()
