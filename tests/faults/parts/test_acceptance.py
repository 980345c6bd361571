"""Every part of `make acceptance` runs to its end at a tiny size."""

import os
import re
import subprocess
import sys

import pytest
from drive import ROOT, SHORT

HERE = (
    "swimming",
    "bodies",
    "searches",
    "databases",
    "takeover",
    "foraging",
    "slopes",
    "page",
    "processors",
)
ELSEWHERE = {
    "uploads": "tests/faults/test_malformed.py",
    "group": "tests/faults/test_group.py",
    "cluster": "tests/faults/test_cluster.py",
    "specs": "tests/engine/search/test_native_specs.py",
}
"""Parts that other tests run at a small size."""


@pytest.mark.long
@pytest.mark.parametrize("part", HERE)
def test_a_part_runs_to_its_end(product, part):
    tests = ROOT / "tests"
    paths = [str(tests / "support"), os.environ.get("PYTHONPATH", "")]
    environment = os.environ | SHORT | {"PYTHONPATH": os.pathsep.join(paths)}
    program = tests / "faults" / "tiny_acceptance.py"
    command = [sys.executable, program, part, product.folder, str(product.port)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-5000:]


def test_every_part_is_run():
    # The program itself imports JAX, which a process of the tests of the server must not.
    text = (ROOT / "tests" / "faults" / "acceptance.py").read_text()
    parts = re.findall(r'^    "(\w+)": \w+,$', text.partition("\nPARTS = {")[2], re.MULTILINE)
    assert sorted(parts) == sorted([*HERE, *ELSEWHERE])
    assert all((ROOT / file).exists() for file in ELSEWHERE.values())
