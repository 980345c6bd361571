"""The native kernel gives the same bits whatever compiles it, and for whatever processor."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from small_spec import SMALL_RUN

ROOT = Path(__file__).parents[3]
SOURCE = ROOT / "engine" / "kernels" / "check" / "evaluations.cpp"
FLAGS = ["-std=c++17", "-O3", "-ffp-contract=off", "-fno-math-errno", "-Wno-psabi"]
AVX512 = ["-mavx512f", "-mavx512vl", "-mavx512dq", "-mavx512bw", "-mprefer-vector-width=512"]
CPU = Path("/proc/cpuinfo")
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


def compiled(compiler, out, *flags):
    subprocess.run([*compiler, *FLAGS, *flags, SOURCE, "-o", out], check=True)
    return [out]


def printed(command, *arguments):
    return subprocess.check_output([*command, *arguments], text=True).split()


@pytest.fixture
def clang(monkeypatch, zig):
    """Zig's clang, which compiles for other processors too.

    Its options are those of the wheels, so that it compiles its C++ library once for both.
    """
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", zig.environment["ZIG_GLOBAL_CACHE_DIR"])
    return [zig.program, "c++", "-fno-sanitize=all", "-fPIC", "-s", "-DNDEBUG"]


def test_compilers_and_processors_give_the_same_bits(tmp_path, clang):
    known = CPU.read_text() if CPU.exists() else ""
    found = {
        "clang": printed(compiled(clang, tmp_path / "clang", "--target=x86_64-linux-gnu.2.17")),
    }
    if shutil.which("g++"):
        found["gcc"] = printed(compiled(["g++"], tmp_path / "gcc"))
        if " avx2 " in known:
            found["gcc, AVX2"] = printed(compiled(["g++"], tmp_path / "avx2", "-mavx2"))
        if " avx512dq " in known:
            found["gcc, AVX-512"] = printed(compiled(["g++"], tmp_path / "wide", *AVX512))
    emulator = shutil.which("qemu-aarch64")
    if emulator and ARM.exists():
        program = compiled(clang, tmp_path / "arm", "--target=aarch64-linux-gnu.2.17")
        found["clang, ARM"] = printed([emulator, "-L", ARM, *program])
    else:
        print(f"SKIPPED: ARM, there is no {ARM if emulator else 'qemu-aarch64'}")
    assert len(set(map(tuple, found.values()))) == 1, found
    assert found["clang"][1] == "100", "some evaluations did not stay finite"


@pytest.fixture
def webassembly(tmp_path, zig):
    """A function that builds the kernel for the page, or a program."""

    def built(*program):
        out = tmp_path / "out.wasm"
        subprocess.run([sys.executable, WASM, out, *program], check=True, env=zig.environment)
        return out

    return built


@pytest.mark.skipif(not NODE, reason="needs node")
def test_webassembly_gives_the_same_bits(tmp_path, clang, webassembly):
    native = printed(compiled(clang, tmp_path / "native"))
    node = [NODE, "--no-warnings", "--input-type=module", "--eval", RUN]
    assert printed([*node, webassembly(SOURCE)]) == native


def test_the_page_has_the_kernel_of_these_sources(webassembly):
    kept = ROOT / "web" / "src" / "simulate" / "kernel.wasm"
    assert webassembly().read_bytes() == kept.read_bytes(), "make simulator builds it anew"


def test_a_run_goes_on_with_another_instruction_set(tmp_path):
    kernels = pytest.importorskip("microcosmos_kernels")
    spec = tmp_path / "spec.json"
    spec.write_text(json.dumps(SMALL_RUN))
    fastest = kernels.instruction_sets()[-1]

    def evolve(out, instruction_set, generations):
        command = [Path(sys.executable).with_name("microcosmos"), "evolve", spec, "--out", out]
        chosen = os.environ | {kernels.VARIABLE: instruction_set, "JAX_PLATFORMS": "cpu"}
        subprocess.run([*command, "--generations", str(generations)], check=True, env=chosen)
        return out.read_bytes()

    whole = evolve(tmp_path / "whole.h5", "basic", 4)
    evolve(tmp_path / "parts.h5", fastest, 2)
    evolve(tmp_path / "parts.h5", "basic", 3)
    assert evolve(tmp_path / "parts.h5", fastest, 4) == whole


@pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")
def test_random_evaluations_stay_within_their_arrays(tmp_path):
    checks = "-O1", "-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=undefined"
    program = compiled(["g++"], tmp_path / "checked", *checks)
    assert printed(program, "1000")[1] == "1000"
