"""Wheels of the native kernel for a release: true tags, and the bits of a local build."""

import json
import os
import platform
import re
import shutil
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from small_spec import SMALL_RUN

ROOT = Path(__file__).parents[3]
LIBRARIES = {"x86_64": {"basic", "avx2", "avx512"}, "aarch64": {"basic"}}
MACHINES = {"x86_64": "Advanced Micro Devices X86-64", "aarch64": "AArch64"}
FROM_THE_C_LIBRARY = re.compile(r"(libc|libm|libdl|libpthread|ld-linux-[\w-]+)\.so\.\d")
EXPORTED = {
    f"microcosmos_{name}"
    for name in ("rollout", "live", "develop", "summarise", "instruction_set")
}
FLAGS = {"avx2": {"avx2"}, "avx512": {"avx512f", "avx512vl", "avx512dq", "avx512bw"}}
"""What Linux calls the instructions that a library needs."""
PIP = ["-m", "pip", "-q", "--disable-pip-version-check"]

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def wheels(tmp_path_factory, zig):
    """The wheel of each processor."""
    out = tmp_path_factory.mktemp("wheels")
    command = [sys.executable, ROOT / "engine" / "kernels" / "wheels.py", out]
    subprocess.run(command, check=True, env=zig.environment)
    return {path.stem.partition("manylinux_2_17_")[2]: path for path in out.iterdir()}


def test_every_processor_has_a_wheel_with_its_libraries(wheels):
    assert wheels.keys() == LIBRARIES.keys()
    for processor, path in wheels.items():
        with ZipFile(path) as wheel:
            names = wheel.namelist()
            (about,) = (name for name in names if name.endswith(".dist-info/WHEEL"))
            tags = re.findall(r"^Tag: (.+)$", wheel.read(about).decode(), re.MULTILINE)
        assert tags == [f"py3-none-manylinux_2_17_{processor}"]
        assert "microcosmos_kernels/__init__.py" in names
        found = {Path(name).stem for name in names if name.endswith(".so")}
        assert found == LIBRARIES[processor]


@pytest.mark.skipif(not shutil.which("readelf"), reason="there is no readelf")
@pytest.mark.parametrize("processor", LIBRARIES)
def test_libraries_need_an_old_c_library_and_nothing_else(tmp_path, wheels, processor):
    with ZipFile(wheels[processor]) as wheel:
        wheel.extractall(tmp_path)
    libraries = sorted(tmp_path.glob("*/*.so"))
    assert {path.stem for path in libraries} == LIBRARIES[processor]
    for library in libraries:
        command = ["readelf", "-hSdVW", "--dyn-syms", library]
        text = subprocess.check_output(command, text=True)
        assert re.findall(r"Machine: +(.+)", text) == [MACHINES[processor]]
        needed = re.findall(r"\(NEEDED\).*\[(.+)\]", text)
        assert needed
        assert all(FROM_THE_C_LIBRARY.fullmatch(name) for name in needed), needed
        versions = re.findall(r"GLIBC_(\d+)\.(\d+)", text)
        assert max((int(major), int(minor)) for major, minor in versions) <= (2, 17)
        assert set(re.findall(r"GLOBAL DEFAULT +\d+ (\w+)", text)) == EXPORTED
        assert ".symtab" not in text


@pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="not x86-64 Linux"
)
def test_an_installed_wheel_gives_the_bits_of_a_local_build(tmp_path, wheels):
    pytest.importorskip("microcosmos_kernels", reason="no kernel was built here: no compiler?")
    fresh = installed(tmp_path, wheels["x86_64"])
    ask = "import microcosmos_kernels as k; print(*k.instruction_sets())"
    sets = subprocess.check_output([fresh / "python", "-c", ask], text=True).split()
    known = set(Path("/proc/cpuinfo").read_text().split())
    assert sets == ["basic", *(name for name, flags in FLAGS.items() if flags <= known)]
    expected = evolved(Path(sys.executable).parent, tmp_path, sets[-1])
    for name in sets:
        assert evolved(fresh, tmp_path, name) == expected, name


def installed(place, kernel):
    """Install the library, a wheel of the kernel and the locked JAX; return where commands are.

    Nothing is compiled.
    """
    build = ["wheel", "--no-build-isolation", "--no-deps", "-w", place, ROOT]
    subprocess.run([sys.executable, *PIP, *build], check=True)
    subprocess.run([sys.executable, "-m", "venv", place / "fresh"], check=True)
    lock = (ROOT / "requirements.lock").read_text()
    pins = (line.rstrip(" \\") for line in lock.splitlines() if line[:1].isalnum())
    (place / "constraints.txt").write_text("\n".join(pins))
    commands = place / "fresh" / "bin"
    chosen = ["--only-binary=:all:", "-c", place / "constraints.txt"]
    given = [*place.glob("*.whl"), kernel]
    subprocess.run([commands / "python", *PIP, "install", *chosen, *given], check=True)
    return commands


def evolved(commands, place, instruction_set):
    """Return the archive that an installation evolves with the kernel."""
    (place / "spec.json").write_text(json.dumps(SMALL_RUN))
    out = place / "archive.h5"
    environment = os.environ | {
        "JAX_PLATFORMS": "cpu",
        "JAX_COMPILATION_CACHE_DIR": str(place / "programs"),
        "MICROCOSMOS_KERNEL": "native",
        "MICROCOSMOS_INSTRUCTION_SET": instruction_set,
    }
    command = [commands / "microcosmos", "evolve", "spec.json", "--out", out]
    subprocess.run(command, check=True, env=environment, cwd=place)
    archive = out.read_bytes()
    out.unlink()
    return archive
