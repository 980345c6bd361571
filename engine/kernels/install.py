"""Build the native kernel and install it beside this Python; `make install` runs it.

`install.py STAMP` touches this file once the kernel is installed.

Uses the system's C++ compiler, or else Zig's from the package registry, which is removed
afterwards. Without both nothing is installed, and an older kernel is removed: JAX then
simulates, several times slower.
"""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

HERE = Path(__file__).parent
ZIG = HERE.parents[1] / "requirements-zig.lock"
PIP = [sys.executable, "-m", "pip", "-q", "--disable-pip-version-check"]
# Without isolation: the lock file has the tools and the interface of XLA.
PIP_BUILD = ["--no-build-isolation", "--no-deps"]


def main(stamp: str | None = None) -> None:
    with tempfile.TemporaryDirectory(prefix="microcosmos-") as place:
        compiler = system_compiler() or zig_compiler(Path(place))
        if compiler and build(compiler):
            if stamp:
                Path(stamp).touch()
            return
    # An older kernel would go on in silence, and may expect other operands.
    subprocess.run([*PIP, "-q", "uninstall", "-y", "microcosmos-kernels"])
    reason = f"{compiler} could not build it" if compiler else "there is no C++ compiler"
    print(
        f"SKIPPED: the native kernel, {reason}; JAX simulates, several times slower. A kernel "
        "that was installed before is removed, since it may be of other sources."
    )


def system_compiler() -> str | None:
    names = (os.environ.get("CXX"), "c++", "g++", "clang++")
    return next((path for name in names if name and (path := shutil.which(name))), None)


def zig(place: Path) -> str | None:
    """Return the program of Zig: that of this environment, or else fetched into a folder."""
    try:
        installed = metadata.distribution("ziglang")
    except metadata.PackageNotFoundError:
        installed = None
    if installed and f"ziglang=={installed.version} " in ZIG.read_text():
        return str(installed.locate_file("ziglang/zig"))
    print("Fetching a C++ compiler for the native kernel ...")
    fetch = [*PIP, "install", "--require-hashes", "--target", place, "-r", ZIG]
    return None if subprocess.run(fetch).returncode else os.fspath(place / "ziglang" / "zig")


def zig_compiler(place: Path) -> str | None:
    """Write the command of Zig's C++ compiler into a folder and return it."""
    program, command = zig(place), place / "c++"
    if not program:
        return None
    # Zig adds checks of undefined behaviour that need a library of its own. It compiles its C++
    # library once for programs and libraries if both are stripped and have the same addressing.
    cache = os.environ.get("ZIG_GLOBAL_CACHE_DIR") or os.fspath(place / "cache")
    command.write_text(
        f"#!/bin/sh\n"
        f"export ZIG_GLOBAL_CACHE_DIR={shlex.quote(cache)}\n"
        f'exec {shlex.quote(program)} c++ -fno-sanitize=all -fPIC -s "$@"\n'
    )
    command.chmod(0o755)
    return os.fspath(command)


def build(compiler: str) -> bool:
    """Build and install with the tools of this environment; return whether that worked."""
    command = [*PIP, "install", *PIP_BUILD, "--force-reinstall", HERE]
    return subprocess.run(command, env=tools(compiler)).returncode == 0


def tools(compiler: str) -> dict[str, str]:
    """Return the environment variables with which the tools of this environment build."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "CXX": compiler}


if __name__ == "__main__":
    main(*sys.argv[1:])
