"""Build the release wheels of the native kernel into a folder; `make wheels` runs it.

Zig's C++ compiler builds for every platform, whatever the machine, and links its own C++
library. It takes the C library from the platform: every one since the version in the tag.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from install import HERE, PIP, PIP_BUILD, tools, zig_compiler

INTERFACE = HERE.parents[1] / "requirements-xla.lock"
PROCESSORS = "x86_64", "aarch64"
GLIBC = "2.17"


def main(out: str) -> None:
    with tempfile.TemporaryDirectory(prefix="microcosmos-") as place:
        compiler = zig_compiler(Path(place))
        if not compiler:
            sys.exit("Zig cannot be fetched from the package registry")
        fetch = [*PIP, "install", "--require-hashes", "--no-deps", "--target", place]
        subprocess.run([*fetch, "-r", INTERFACE], check=True)
        # CMake asks this jaxlib for the headers, not the newer one of this environment.
        environment = tools(compiler) | {"PYTHONPATH": place}
        for processor in PROCESSORS:
            print(f"Building the wheel for {processor} ...", flush=True)
            build(processor, out, environment)


def build(processor: str, out: str, environment: dict[str, str]) -> None:
    settings = [
        f"-Cwheel.tags=py3-none-manylinux_{GLIBC.replace('.', '_')}_{processor}",
        "-Cinstall.strip=false",  # Zig has done it; this machine's `strip` may not know how.
        "-Ccmake.define.CMAKE_SYSTEM_NAME=Linux",
        f"-Ccmake.define.CMAKE_SYSTEM_PROCESSOR={processor}",
    ]
    command = [*PIP, "wheel", *PIP_BUILD, *settings, "-w", out, HERE]
    target = {"CXXFLAGS": f"--target={processor}-linux-gnu.{GLIBC}"}
    subprocess.run(command, env=environment | target, check=True)


if __name__ == "__main__":
    main(sys.argv[1])
