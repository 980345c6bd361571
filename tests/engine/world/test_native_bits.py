"""The native kernel gives the same bits for every processor.

That compilers agree shows `test_native_wheels.py`, whose wheel another one has built.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SOURCE = ROOT / "engine" / "kernels" / "check" / "evaluations.cpp"
FLAGS = ["-std=c++17", "-O3", "-ffp-contract=off", "-fno-math-errno", "-Wno-psabi"]
X86 = "x86_64-linux-gnu.2.17"
EMULATOR = shutil.which("qemu-aarch64")
WASM = ROOT / "engine" / "kernels" / "wasm.py"
NODE = shutil.which(
    "node", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
)
RUN = """
import { readFileSync } from "node:fs";
import { WASI } from "node:wasi";
const wasi = new WASI({ version: "preview1", args: ["evaluations"] });
const module = new WebAssembly.Module(readFileSync(process.argv[1]));
wasi.start(new WebAssembly.Instance(module, wasi.getImportObject()));
"""
"""Runs a program of WebAssembly."""
ARM = Path("/usr/aarch64-linux-gnu")
"""The C library of ARM, where Debian's `libc6-arm64-cross` puts it."""

pytestmark = pytest.mark.long
needs_gcc = pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")


def compiled(compiler, out, *flags):
    subprocess.run([*compiler, *FLAGS, *flags, SOURCE, "-o", out], check=True)
    return [out]


def printed(command, *arguments):
    return subprocess.check_output([*command, *arguments], text=True).split()


def clang(zig, target):
    """Return the command of Zig's clang for a processor.

    Options and targets are those of the wheels: Zig then compiles its C++ library, which takes
    minutes, once for both.
    """
    cached = f"ZIG_GLOBAL_CACHE_DIR={zig.environment['ZIG_GLOBAL_CACHE_DIR']}"
    command = [zig.program, "c++", "-fno-sanitize=all", "-fPIC", "-s", "-DNDEBUG"]
    return ["env", cached, *command, f"--target={target}"]


@pytest.fixture(scope="module")
def expected(tmp_path_factory, zig):
    """The bits of the compiler of this machine, or of Zig's where there is none."""
    compiler = ["g++"] if shutil.which("g++") else clang(zig, X86)
    found = printed(compiled(compiler, tmp_path_factory.mktemp("here") / "program"))
    assert found[1] == "100", "some evaluations did not stay finite"
    return found


@pytest.mark.skipif(not EMULATOR or not ARM.exists(), reason=f"needs qemu-aarch64 and {ARM}")
def test_arm_gives_the_same_bits(tmp_path, expected, zig):
    program = compiled(clang(zig, "aarch64-linux-gnu.2.17"), tmp_path / "arm")
    assert printed([EMULATOR, "-L", ARM, *program]) == expected


@pytest.fixture
def webassembly(tmp_path, zig):
    """A function that builds the kernel for the page, or a program."""

    def built(*program):
        out = tmp_path / "out.wasm"
        subprocess.run([sys.executable, WASM, out, *program], check=True, env=zig.environment)
        return out

    return built


@pytest.mark.skipif(not NODE, reason="needs node")
def test_webassembly_gives_the_same_bits(expected, webassembly):
    node = [NODE, "--no-warnings", "--input-type=module", "--eval", RUN]
    assert printed([*node, webassembly(SOURCE)]) == expected


def test_the_page_has_the_kernel_of_these_sources(webassembly):
    kept = ROOT / "web" / "src" / "simulate" / "kernel.wasm"
    assert webassembly().read_bytes() == kept.read_bytes(), "make simulator builds it anew"


@needs_gcc
def test_random_evaluations_stay_within_their_arrays(tmp_path):
    checks = "-O1", "-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=undefined"
    program = compiled(["g++"], tmp_path / "checked", *checks)
    assert printed(program, "1000")[1] == "1000"
