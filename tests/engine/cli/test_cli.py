"""Commands that carry out, resume and extend runs, repeat creatures and refuse mistakes."""

import gzip
import json
import os
import signal
import subprocess
import sys
import time
from hashlib import md5
from importlib import import_module

import httpx
import numpy as np
import pytest
from small_spec import SMALL_SCENE

from microcosmos.archive.file import read_table
from microcosmos.cli import pictures, remote, reproject
from microcosmos.cli.app import failing
from microcosmos.spec import World
from microcosmos.viz.figures import maps

run_command = import_module("microcosmos.cli.run")

SPEC = SMALL_SCENE | {"seed": 5, "search": {"generations": 12, "batch": 16}}


@pytest.fixture
def run(tmp_path):
    """A function that starts the command in a folder of its own."""
    cache = os.environ["MICROCOSMOS_TEST_COMPILED"]
    environment = os.environ | {"JAX_COMPILATION_CACHE_DIR": cache}

    def start(*arguments):
        command = [sys.executable, "-m", "microcosmos", *arguments]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
        return subprocess.Popen(command, cwd=tmp_path, env=environment, **pipes)

    return start


def finished(process, code=0) -> str:
    text, _ = process.communicate(timeout=300)
    assert process.returncode == code, text
    return text


@pytest.mark.long
def test_a_stopped_and_extended_run_ends_with_the_bytes_of_a_longer_one(run, invoke, tmp_path):
    (tmp_path / "spec.json").write_text(json.dumps(SPEC))
    finished(run("evolve", "spec.json", "--generations", "13", "--out", "whole.h5"))
    stopped = run("evolve", "spec.json", "--checkpoint-seconds", "0")
    archive = tmp_path / "spec.h5"
    while not archive.exists() and stopped.poll() is None:
        time.sleep(0.02)
    stopped.send_signal(signal.SIGTERM)
    assert "goes on from" in finished(stopped, code=130)
    assert "Done" in finished(run("evolve", "spec.json"))
    assert archive.read_bytes() != (tmp_path / "whole.h5").read_bytes()
    invoke("evolve", "spec.json", "--generations", "13")
    assert archive.read_bytes() == (tmp_path / "whole.h5").read_bytes()
    assert "elites; distances in body lengths" in invoke("variety", "spec.h5")
    assert json.loads(invoke("variety", "spec.h5", "--json"))["kinds"] >= 1
    text = invoke("evolve", "spec.json", code=2)
    assert "must be at least the file's 13, got 12" in text
    assert "The same, bit for bit." in invoke("replay", "spec.best.json", "--check")
    text = invoke("refine", "spec.best.json", "--out", "spec.json/x.h5", code=2)
    assert "--out needs a folder that can be made" in text


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("evolve wrong.json", "world.viscosity"),
        ("evolve nonsense", "got nonsense"),
        ("evolve nonsense", "demo"),
        ("replay empty.json --check", "identity"),
        ("variety empty.json", "an archive file must be HDF5"),
        ("figure creature.replay creature.bmp", ".mp4"),
        ("figure empty.json x.mp4", "microcosmos[figures]"),
        ("figure empty.json x.gif --audit empty.json", "`--audit` needs a .png of a creature"),
        ("figure empty.json x.png --audit empty.json", "`--audit` needs a report of"),
        ("figure curves . x.pdf", "FILE must be a file, no folder or pipe; got ."),
        ("figure kinds nowhere.h5 x.pdf", "FILE must exist; not found: nowhere.h5"),
        ("evolve run.h5", "run.h5: JSON must be text in UTF-8; got other bytes"),
        ("evolve demo --out .", "--out: a file is needed, got the folder ."),
        ("evolve demo --certificate x.pem", "--certificate needs --cluster"),
        ("reproject empty.json", "empty.json: an archive file must be HDF5"),
        (f"picture --text {'a' * 101}", "--text needs at most 100 characters"),
        (f"evolve {'a' * 300}", "SPEC: [Errno 36] File name too long"),
        ("picture cut.gz --number 0", "`path` must be a whole gzip file, got 'cut.gz'"),
        ("picture bad.gz --number 0", "`path` must be a whole gzip file, got 'bad.gz'"),
    ],
)
def test_mistakes_are_refused_with_their_reason(command, words, invoke, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "av", None)
    (tmp_path / "wrong.json").write_text(json.dumps(SPEC | {"world": {"viscosity": -1}}))
    (tmp_path / "empty.json").write_text("{}")
    packed = gzip.compress(b"pictures" * 9)
    (tmp_path / "cut.gz").write_bytes(packed[:-9])
    (tmp_path / "bad.gz").write_bytes(packed[:10] + b"\xff" * 9 + packed[19:])
    (tmp_path / "run.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
    (tmp_path / "creature.replay").write_bytes(b"nothing")
    assert words in invoke(*command.split(), code=2)


def test_a_strip_states_the_verdict_of_the_creatures_own_audit(invoke, tmp_path, replay_bytes):
    positions = np.zeros((6, 3, 2)) + np.arange(3)[None, :, None]
    levels = np.zeros((6, 16, 16))
    data = replay_bytes(positions, [[0, 1], [1, 2]], levels, creature="ab" * 32)
    (tmp_path / "eel.replay").write_bytes(data)
    report = {"creature": "ab" * 32, "verdict": {"trusted": True}}
    (tmp_path / "audit.json").write_text(json.dumps(report))
    (tmp_path / "other.json").write_text(json.dumps(report | {"creature": "cd" * 32}))
    invoke("figure", "eel.replay", "plain.png")
    invoke("figure", "eel.replay", "noted.png", "--audit", "audit.json")
    plain, noted = (tmp_path / name for name in ("plain.png", "noted.png"))
    assert plain.read_bytes() != noted.read_bytes()
    text = invoke("figure", "eel.replay", "x.png", "--audit", "other.json", code=2)
    assert "needs the audit of abababababab, got that of cdcdcdcdcdcd" in text
    assert not (tmp_path / "x.png").exists()


def test_evolve_sets_fields_and_makes_the_folder_of_its_file(invoke, tmp_path, monkeypatch):
    carried = []
    monkeypatch.setattr(
        run_command, "run_with_progress", lambda *given, **_: carried.append(given)
    )
    (tmp_path / "spec.json").write_text(json.dumps(SPEC))
    command = ["evolve", "spec.json", "--out", "new/folder/x.h5"]
    invoke(*command, "--set", "world.viscosity=0.07")
    assert carried[0][0].world.viscosity == 0.07
    assert (tmp_path / "new" / "folder").is_dir()
    invoke(*command, "--set", "world.viscosity=-1", code=2)
    # A mistake is told before JAX starts.
    monkeypatch.setattr("microcosmos.device.prepare", lambda **_: pytest.fail("too early"))
    (tmp_path / "choices.json").write_text('{"choices": []}')
    refused = invoke(*command, "--choices", "choices.json", code=2)
    assert "--choices: choices.json: `creatures` needs a value" in refused


@pytest.mark.long
def test_a_sweep_is_carried_out_drawn_and_its_table_read(run, tmp_path):
    spec = {"experiment": "gaits", "swimmers": ["worm"], "forms": ["ours"]}
    spec |= {"viscosities": [0.5, 2.0], "period": 40, "cycles": 2}
    (tmp_path / "sweep.json").write_text(json.dumps(spec))
    assert "Done" in finished(run("evolve", "sweep.json"))
    assert "sweep.svg" in finished(run("figure", "sweep.h5", "sweep.svg"))
    assert "worm" in (tmp_path / "sweep.svg").read_text()
    table = read_table((tmp_path / "sweep.h5").read_bytes())
    assert [row["viscosity"] for row in table.rows] == [0.5, 2.0]


@pytest.mark.long
def test_a_filament_folds_into_a_packed_picture_and_is_drawn(run, tmp_path):
    packed = json.loads(finished(run("picture", "--text", "o", "--name", "a ring")))
    assert packed["name"] == "a ring"
    spec = {"experiment": "folding", "targets": [packed], "steps": 10, "size": 16, "updates": 3}
    spec["world"] = {"width": 24, "height": 24, "fluid": False}
    spec["body"] = {"builder": "walk", "nodes": 24}
    (tmp_path / "ring.json").write_text(json.dumps(spec))
    assert "Done" in finished(run("evolve", "ring.json"))
    assert "ring.svg" in finished(run("figure", "ring.h5", "ring.svg"))
    assert "a ring" in (tmp_path / "ring.svg").read_text()
    assert json.loads((tmp_path / "ring.best.json").read_text())["measured"] is None
    assert "FILE or --text" in finished(run("picture"), code=2)


def test_a_closed_pipe_is_left_to_click_which_ends_quietly():
    for context in (failing(), remote._connected()):
        with pytest.raises(BrokenPipeError), context:
            raise BrokenPipeError


@pytest.mark.parametrize("given", ["--version", "--help"])
@pytest.mark.parametrize(
    ("shell", "said"),
    [
        (">&-", "Standard output must be open; to discard it, add >/dev/null.\n"),
        ("| true; exit ${PIPESTATUS[0]}", ""),
    ],
)
def test_output_that_nobody_can_read_is_an_error_in_at_most_a_sentence(given, shell, said):
    line = f"{sys.executable} -m microcosmos {given} {shell}"
    done = subprocess.run(["bash", "-c", line], stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (1, said)


def test_a_command_without_its_library_says_what_to_install(invoke, monkeypatch):
    def draw(*_):
        raise ImportError('matplotlib is needed: pip install "microcosmos[figures]"')

    monkeypatch.setattr(maps, "draw_reprojections", draw)
    monkeypatch.setattr(reproject, "_read", lambda *_: (None, [], {}, ""))
    monkeypatch.setattr(reproject, "over", lambda *_: (None, []))
    monkeypatch.setattr(reproject, "_print", lambda *_: None)
    text = invoke("reproject", "a.h5", "--figure", "a.png", code=1)
    assert text == 'matplotlib is needed: pip install "microcosmos[figures]"'


def test_words_become_an_obstacle(invoke):
    packed = json.loads(invoke("picture", "--text", "o", "--obstacle"))
    solid = World(width=64, height=64, obstacles=[packed]).solid
    assert not solid[32, 32], "the hole of an o"
    assert solid[:, 32].any()
    assert solid[32].any()
    assert not solid[0, 0]


def test_mnist_is_fetched_once_and_verified(invoke, tmp_path, monkeypatch):
    served, requested = {"a": b"images", "b": b"broken"}, []

    def get(url, **_):
        requested.append(url)
        return httpx.Response(200, content=served[url[-1]], request=httpx.Request("GET", url))

    monkeypatch.setattr(httpx, "get", get)
    digest = md5(b"images", usedforsecurity=False).hexdigest()
    monkeypatch.setattr(pictures, "MNIST_FILES", {"a": digest})
    for _ in range(2):
        invoke("data", "mnist", "mnist")
    assert requested == [pictures.MNIST + "a"]
    assert (tmp_path / "mnist" / "a").read_bytes() == b"images"
    monkeypatch.setattr(pictures, "MNIST_FILES", {"b": digest})
    invoke("data", "mnist", "mnist", code=2)
    assert not (tmp_path / "mnist" / "b").exists()
    (tmp_path / "mnist" / "b").mkdir()
    text = invoke("data", "mnist", "mnist", code=2)
    assert "a file is needed, got the folder mnist/b" in text
