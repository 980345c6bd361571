"""The native kernel under sanitisers: nothing outside arrays is read or written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import jax
import pytest

pytest.importorskip(
    "microcosmos_kernels", reason="microcosmos-kernels is not installed: no compiler?"
)
ROOT = Path(__file__).parents[3]
KERNELS = ROOT / "engine" / "kernels"
FLAGS = (
    "-std=c++17 -O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=undefined "
    "-ffp-contract=off -Wno-psabi -fPIC -shared"
)
RUN = """
import jax
from kernel_scenes import SCENES, run
from microcosmos import world

for make in SCENES.values():
    jax.block_until_ready(run(world.native.rollout, make(), 10))
print("nothing found")
"""


@pytest.mark.long
@pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")
def test_the_scenes_of_the_tests_stay_within_their_arrays(tmp_path):
    package = tmp_path / "microcosmos_kernels"
    package.mkdir()
    shutil.copy(KERNELS / "microcosmos_kernels" / "__init__.py", package)
    include = ["-isystem", jax.ffi.include_dir(), str(KERNELS / "src" / "ffi.cpp")]
    subprocess.run(["g++", *FLAGS.split(), *include, "-o", package / "basic.so"], check=True)
    libraries = [
        subprocess.check_output(["g++", f"-print-file-name={name}"], text=True).strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    environment = os.environ | {
        "LD_PRELOAD": " ".join(libraries),
        "ASAN_OPTIONS": "detect_leaks=0",  # Python and XLA leak.
        "PYTHONPATH": os.pathsep.join(map(str, (tmp_path, ROOT / "tests" / "support"))),
    }
    done = subprocess.run([sys.executable, "-c", RUN], env=environment, capture_output=True)
    assert done.stdout.decode().strip() == "nothing found", done.stderr.decode()[-3000:]


@pytest.mark.long
@pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")
def test_any_body_that_the_boundary_accepts_stays_within_its_arrays():
    """`make fuzz` simulates 100,000 of these worlds, and of these crowds."""
    command = ["make", "--no-print-directory", "fuzz", "WORLDS=300"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    worlds, crowds = done.stdout.splitlines() or ("", "")
    assert worlds.startswith("300 worlds, "), done.stdout + done.stderr[-3000:]
    assert crowds.startswith("300 crowds, "), done.stdout + done.stderr[-3000:]
    assert int(crowds.split()[2]) > 500  # Creatures: few crowds are refused.
