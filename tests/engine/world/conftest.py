"""What the tests of the native kernel's compilers share."""

import fcntl
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[3]
LOCK = ROOT / "requirements-zig.lock"
CACHE = ROOT / ".cache" / "zig"
PIP = [sys.executable, "-m", "pip", "-q", "--disable-pip-version-check"]


class Zig(NamedTuple):
    program: Path
    environment: dict[str, str]
    """Where the scripts of engine/kernels find it and keep the C++ library of each target."""


@pytest.fixture(scope="session")
def zig():
    """Zig, fetched once for all processes from the package registry.

    Its folder is safe to delete.
    """
    version = LOCK.read_text().partition("ziglang==")[2].split()[0]
    place = CACHE / version
    place.mkdir(parents=True, exist_ok=True)
    program = place / "ziglang" / "zig"
    with (CACHE / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "whole").exists():
            fetch = ["install", "--require-hashes", "--upgrade", "--target", place, "-r", LOCK]
            if subprocess.run([*PIP, *fetch]).returncode:
                pytest.skip("Zig cannot be fetched from the package registry")
            (place / "whole").touch()
    found = {"PYTHONPATH": str(place), "ZIG_GLOBAL_CACHE_DIR": str(CACHE)}
    return Zig(program, os.environ | found)
