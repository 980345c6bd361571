"""The tutorial quotes the figures of its runs, which are the same on every machine."""

import os
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from microcosmos.client.formatting import figures

TUTORIAL = Path(__file__).parents[1] / "docs" / "tutorial.md"

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tutorial")


@pytest.mark.parametrize("name", ["first", "thick"])
def test_the_line_at_the_end_of_a_run_is_that_of_the_tutorial(name, folder):
    settings = {"thick": ("--set", "world.viscosity=0.3")}.get(name, ())
    command = [sys.executable, "-m", "microcosmos", "evolve", "demo", *settings]
    environment = os.environ | {"JAX_PLATFORMS": "cpu"}
    subprocess.run([*command, "--out", f"{name}.h5"], cwd=folder, env=environment, check=True)
    with h5py.File(folder / f"{name}.h5") as file:
        record = {key: file["curves"][key][-1] for key in ("qd_score", "coverage", "best")}
    shown = "  ".join(f"{title} {text}" for title, text in figures(record))
    text = TUTORIAL.read_text()
    assert f"finished  300/300 generations  {shown}\n" in text
    if name == "first":
        _, (_, coverage), (_, best) = figures(record)
        assert f"swimmer moves {best} of its own length" in text
        assert f"of which {coverage} hold an elite" in text
