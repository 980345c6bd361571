"""Build the native kernel as WebAssembly for the page; `make simulator` runs it.

Zig's C++ compiler gives the same bytes on every machine, so the repository keeps the file, and
building the page needs no compiler. `wasm.py OUT PROGRAM` builds a program of C++ instead.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from install import HERE, zig

TARGET = "--target=wasm32-wasi", "-msimd128", "-fno-exceptions", "-fno-rtti"
FLAGS = "-std=c++17", "-O3", "-ffp-contract=off", "-fno-math-errno", "-fno-sanitize=all", "-s"
KERNEL = os.fspath(HERE / "src" / "wasm.cpp"), "-mexec-model=reactor"


def main(out: str, *program: str) -> None:
    with tempfile.TemporaryDirectory(prefix="microcosmos-") as place:
        compiler = zig(Path(place))
        if not compiler:
            sys.exit("Zig cannot be fetched from the package registry")
        cached = {"ZIG_GLOBAL_CACHE_DIR": f"{place}/cache", **os.environ}
        command = [compiler, "c++", "-DNDEBUG", *TARGET, *FLAGS, *(program or KERNEL)]
        subprocess.run([*command, "-o", out], env=cached, check=True)
    Path(out).chmod(0o644)


if __name__ == "__main__":
    main(*sys.argv[1:])
