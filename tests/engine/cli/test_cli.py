"""The command line carries a run out, takes it up again and repeats a creature."""

import json
import os
import signal
import subprocess
import sys
import time
from importlib import import_module
from io import StringIO

import pytest
from rich.console import Console
from typer.testing import CliRunner

from microcosmos.archive.file import read_table
from microcosmos.cli import app, draw

run_command = import_module("microcosmos.cli.run")
cli_app = import_module("microcosmos.cli.app")

SPEC = {
    "experiment": "quality-diversity",
    "seed": 5,
    "world": {"width": 32, "height": 32},
    "body": {"nodes": 12},
    "control": {"period": 30},
    "task": {"steps": 60},
    "search": {"generations": 12, "batch": 16},
}


@pytest.fixture
def run(tmp_path):
    """A function that starts the command in a folder of its own."""
    cache = os.environ["MICROCOSMOS_TEST_COMPILED"]
    environment = os.environ | {"JAX_COMPILATION_CACHE_DIR": cache}

    def start(*arguments, **options):
        command = [sys.executable, "-m", "microcosmos.cli", *arguments]
        return subprocess.Popen(
            command,
            cwd=tmp_path,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            **options,
        )

    return start


def finished(process, code=0) -> str:
    text, _ = process.communicate(timeout=300)
    assert process.returncode == code, text
    return text


def test_a_run_stopped_by_a_signal_goes_on_and_ends_with_the_same_bytes(run, tmp_path):
    (tmp_path / "spec.json").write_text(json.dumps(SPEC))
    finished(run("evolve", "spec.json", "--out", "whole.h5"))
    stopped = run("evolve", "spec.json", "--checkpoint-seconds", "0")
    archive = tmp_path / "spec.h5"
    while not archive.exists() and stopped.poll() is None:
        time.sleep(0.02)
    stopped.send_signal(signal.SIGTERM)
    assert "goes on from" in finished(stopped, code=130)
    assert archive.read_bytes() != (tmp_path / "whole.h5").read_bytes()
    assert "Done" in finished(run("evolve", "spec.json"))
    assert archive.read_bytes() == (tmp_path / "whole.h5").read_bytes()
    finished(run("evolve", "spec.json", "--generations", "13"))
    finished(run("evolve", "spec.json", "--generations", "13", "--out", "fresh.h5"))
    assert archive.read_bytes() == (tmp_path / "fresh.h5").read_bytes()
    text = " ".join(finished(run("evolve", "spec.json"), code=2).split())
    assert "must be at least the file's 13, got 12" in text
    text = finished(run("replay", "spec.best.json", "--check"))
    assert "The same, bit for bit." in text
    text = finished(run("refine", "spec.best.json", "--out", "spec.json/x.h5"), code=2)
    assert "--out needs a folder that can be made" in text


def test_a_wrong_spec_is_refused_with_its_field(run, tmp_path):
    (tmp_path / "spec.json").write_text(json.dumps(SPEC | {"world": {"viscosity": -1}}))
    text = finished(run("evolve", "spec.json"), code=2)
    assert "world.viscosity" in text


def test_evolve_sets_fields_and_makes_the_folder_of_its_file(tmp_path, monkeypatch):
    carried = []
    monkeypatch.setattr(run_command, "carry_on", lambda *given: carried.append(given) or True)
    monkeypatch.setattr("microcosmos.device.prepare", lambda **_: None)  # JAX runs already.
    (tmp_path / "spec.json").write_text(json.dumps(SPEC))
    out = tmp_path / "new" / "folder" / "x.h5"
    command = ["evolve", str(tmp_path / "spec.json"), "--out", str(out)]
    found = CliRunner().invoke(app, [*command, "--set", "world.viscosity=0.07"])
    assert found.exit_code == 0, found.output
    assert carried[0][0].world.viscosity == 0.07
    assert out.parent.is_dir()
    refused = CliRunner().invoke(app, [*command, "--set", "world.viscosity=-1"])
    assert refused.exit_code == 2


def test_a_film_without_its_library_is_refused_before_the_simulation(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    (tmp_path / "creature.json").write_text("{}")
    command = ["figure", str(tmp_path / "creature.json"), str(tmp_path / "x.mp4")]
    monkeypatch.setattr(draw, "console", Console(file=(text := StringIO())))
    monkeypatch.setattr(cli_app, "console", draw.console)
    assert CliRunner().invoke(app, command).exit_code == 2
    assert "microcosmos[figures]" in text.getvalue()


def test_a_name_that_is_no_file_is_refused_with_the_presets(run):
    text = finished(run("evolve", "nonsense"), code=2)
    assert "demo" in text
    assert "nonsense" in text


def test_a_creature_that_is_not_sound_is_refused(run, tmp_path):
    (tmp_path / "creature.json").write_text("{}")
    assert "identity" in finished(run("replay", "creature.json", "--check"), code=2)


@pytest.mark.long
def test_a_sweep_is_carried_out_drawn_and_its_table_read(run, tmp_path):
    spec = {
        "experiment": "gaits",
        "swimmers": ["worm"],
        "forms": ["ours"],
        "viscosities": [0.5, 2.0],
        "period": 40,
        "cycles": 2,
    }
    (tmp_path / "sweep.json").write_text(json.dumps(spec))
    assert "Done" in finished(run("evolve", "sweep.json"))
    assert "sweep.svg" in finished(run("figure", "sweep.h5", "sweep.svg"))
    assert "worm" in (tmp_path / "sweep.svg").read_text()
    table = read_table((tmp_path / "sweep.h5").read_bytes())
    assert [row["viscosity"] for row in table.rows] == [0.5, 2.0]


def test_a_picture_of_an_unknown_kind_is_refused(run, tmp_path):
    (tmp_path / "creature.replay").write_bytes(b"nothing")
    text = finished(run("figure", "creature.replay", "creature.bmp"), code=2)
    assert ".mp4" in text


@pytest.mark.long
def test_a_filament_folds_into_a_packed_picture_and_is_drawn(run, tmp_path):
    packed = json.loads(finished(run("picture", "--text", "o", "--name", "a ring")))
    assert packed["name"] == "a ring"
    spec = {
        "experiment": "folding",
        "targets": [packed],
        "world": {"width": 24, "height": 24, "fluid": False},
        "body": {"builder": "walk", "nodes": 24},
        "steps": 10,
        "size": 16,
        "updates": 3,
    }
    (tmp_path / "ring.json").write_text(json.dumps(spec))
    assert "Done" in finished(run("evolve", "ring.json"))
    assert "ring.svg" in finished(run("figure", "ring.h5", "ring.svg"))
    assert "a ring" in (tmp_path / "ring.svg").read_text()
    assert json.loads((tmp_path / "ring.best.json").read_text())["measured"] is None
    text = finished(run("picture"), code=2)
    assert "FILE or --text" in text


def test_mnist_is_fetched_verified_and_not_fetched_twice(tmp_path, monkeypatch):
    from hashlib import md5

    import httpx
    from typer.testing import CliRunner

    from microcosmos.cli import app, pictures

    served, asked = {"a": b"images", "b": b"broken"}, []

    def get(url, **_):
        asked.append(url)
        return httpx.Response(200, content=served[url[-1]], request=httpx.Request("GET", url))

    monkeypatch.setattr(httpx, "get", get)
    digest = md5(b"images", usedforsecurity=False).hexdigest()
    monkeypatch.setattr(pictures, "MNIST_FILES", {"a": digest})
    command = ["data", "mnist", str(tmp_path / "mnist")]
    for _ in range(2):
        assert CliRunner().invoke(app, command).exit_code == 0
    assert asked == [pictures.MNIST + "a"]
    assert (tmp_path / "mnist" / "a").read_bytes() == b"images"
    monkeypatch.setattr(pictures, "MNIST_FILES", {"b": digest})
    assert CliRunner().invoke(app, command).exit_code == 2
    assert not (tmp_path / "mnist" / "b").exists()
