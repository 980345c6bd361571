"""The command `reproject` on an archive file, and its figure."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from microcosmos.archive import file
from microcosmos.cli import app
from microcosmos.spec import QualityDiversity

MEASURES = ("mach", "symmetry", "curvature_mean")


@pytest.fixture
def archive(tmp_path):
    rng = np.random.default_rng(0)
    measures = np.stack([10 ** rng.uniform(-3, 0, 40), *rng.uniform(0, 0.3, (2, 40))], 1)
    tree = {
        "measures": measures.astype(np.float32),
        "fitness": rng.uniform(0, 1, 40).astype(np.float32),
        "generation": np.arange(40),
        "creature": rng.integers(0, 256, (40, 32), dtype=np.uint8),
        "cell": np.arange(40),
    }
    spec = QualityDiversity().model_dump_json()
    attributes = {"format": file.FORMAT, "spec": spec, "measures": json.dumps(MEASURES)}
    path = tmp_path / "archive.h5"
    path.write_bytes(file.dump({"archive": tree}, attributes))
    return path


def command(*arguments, code=0):
    done = CliRunner().invoke(app, ["reproject", *map(str, arguments)])
    assert done.exit_code == code, done.output
    return done


def test_a_file_has_the_measures_of_its_elites_only(archive):
    done = command(archive, "--axes", "mach,curvature_mean", "--json")
    assert "its 40 elites only" in done.stderr
    found = json.loads(done.stdout)
    assert [one["of"] for one in found["of"]] == ["present elites"]
    assert [axis["bins"] for axis in found["axes"]] == [24, 20]
    assert command(archive, "--of", "elites", "--axes", "mach").stderr.count("\n") == 1


def test_a_file_needs_no_server(archive, monkeypatch):
    monkeypatch.setenv("MICROCOSMOS_TOKEN", "a b")
    assert "bins" in command(archive, "--axes", "mach").stderr
    assert "`token` must be ASCII" in command("0f3c", code=1).stderr


def test_components_are_printed_and_drawn(archive, tmp_path):
    out = tmp_path / "map.png"
    done = command(archive, "--figure", out)
    assert done.stdout.splitlines()[-2].startswith("pc1  ")
    assert "of the variance: " in done.stdout
    assert out.read_bytes().startswith(b"\x89PNG")
    caption = out.with_suffix(".caption.txt").read_text()
    assert caption.startswith("The fittest creature of each of 24 × 24 cells over principal")
    assert "of archive.h5: present elites, " in caption
