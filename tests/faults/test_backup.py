"""A backup of a running product, restored elsewhere, finishes its run with the same bytes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from drive import ROOT, SERVICES, SHORT, Installation, running

pytestmark = pytest.mark.long


def maintain(product: Installation, folder: Path, *words: str) -> str:
    inherited = {name: value for name, value in os.environ.items() if name not in SERVICES}
    settings = product.environment | {"MICROCOSMOS_DATA": str(folder)}
    command = [sys.executable, "-m", "microcosmos_server.maintenance", *words]
    done = subprocess.run(
        command, cwd=ROOT, env=inherited | settings, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_run_in_progress_ends_alike_in_both(product, spec, tmp_path):
    run = product.submit(spec | {"search": spec["search"] | {"generations": 100}})
    product.reach(run, 3)
    with product.slowed():
        maintain(product, product.folder, "backup", str(tmp_path / "backup"))
        seen = product.read(run)
    assert seen["status"] == "running"
    said = maintain(product, tmp_path / "data", "restore", str(tmp_path / "backup"))
    assert "is restored" in said
    product.wait(run, "finished", seconds=300)
    with running(tmp_path / "data", SHORT) as other:
        found = other.wait(run, "finished", seconds=300)
        assert (found["error"], found["attempt"]) == (None, seen["attempt"] + 1)
        assert other.results(run) == product.results(run)
