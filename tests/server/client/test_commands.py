"""The commands and the doctor, over a real server."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import pytest
from click.testing import Result
from pydantic import SecretStr
from typer.testing import CliRunner

from microcosmos.archive import creature, creature_h5
from microcosmos.cli import app
from microcosmos.doctor.server import server


@pytest.fixture
def command(address: str, monkeypatch) -> Callable[..., Result]:
    """Carries a command out, which has to end as expected."""
    monkeypatch.setenv("MICROCOSMOS_URL", address)
    monkeypatch.setenv("COLUMNS", "200")

    def carry_out(*arguments: str, code: int = 0, **options: Any) -> Result:
        found = CliRunner().invoke(app, list(arguments), **options)
        assert found.exit_code == code, found.output
        return found

    return carry_out


def test_a_run_is_submitted_listed_and_downloaded(command, client):
    made = command("submit", "demo", "--set", "seed=11", "--name", "first")
    (id,) = made.stdout.split()
    run = client.run(id)
    assert (run.name, run.spec["seed"]) == ("first", 11)
    assert f"microcosmos watch {id[:8]}" in made.stderr
    listed = command("runs", "--search", "first").stdout
    assert id[:8] in listed
    assert "queued" in listed
    assert json.loads(command("runs", "--json").stdout)[0]["id"] == id
    assert json.loads(command("runs", "--json", "--status", "failed").stdout) == []
    assert "paused" in command("pause", id[:8]).stderr
    assert "queued" in command("resume", id[:8]).stderr
    assert "cancelled" in command("cancel", id[:8]).stderr
    assert command("watch", "--last", code=1).stderr.count("cancelled") == 1


def test_errors_are_sentences_and_exit_with_1(command):
    wrong = command("submit", "demo", "--set", "world.viscosity=-1", code=1)
    assert "world.viscosity" in wrong.stderr
    assert wrong.stdout == ""
    assert "Traceback" not in wrong.output
    assert "presets" in command("submit", "nonsense", code=1).stderr
    assert "begins with 00000000" in command("pull", "00000000", code=1).stderr
    nobody = command("runs", "--url", "http://127.0.0.1:9", code=1)
    assert "No server answers at http://127.0.0.1:9" in nobody.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("submit", "demo", "--set", "seed"),
        ("submit", "demo", "--set", "archive.descriptors.9.bins=3"),
        ("watch",),
        ("watch", "abc", "--last"),
        ("fork", "abc", "--all", "--cells", "3"),
        ("fork", "abc", "--cells", "x"),
        ("fork", "abc", "--region", "turning=1"),
        ("fork", "abc", "--set", "archive.descriptors.0.bins=3"),
    ],
)
def test_invalid_usage_exits_with_2(command, arguments):
    assert "Usage" in command(*arguments, code=2).stderr


def test_a_file_is_pulled_under_the_runs_name(command, run_id, tmp_path, attempt, record):
    record(1)
    attempt.save(1, b"the archive")
    pulled = command("pull", str(run_id), "--out", str(tmp_path)).stdout.strip()
    assert pulled == str(tmp_path / f"quality-diversity-{str(run_id)[:8]}.h5")
    assert (tmp_path / pulled).read_bytes() == b"the archive"
    assert "existing folder" in command("pull", str(run_id), "--out", "no/x", code=1).stderr


def test_creatures_are_imported_with_their_hashes(command, client, identity, tmp_path):
    file = creature.document(identity(3), None, None)
    (tmp_path / "one.json").write_text(json.dumps(file))
    assert command("import", str(tmp_path / "one.json")).stdout.strip() == file["sha256"]
    (tmp_path / "one.h5").write_bytes(creature_h5.dump(file))
    assert command("import", str(tmp_path / "one.h5")).stdout.strip() == file["sha256"]
    (tmp_path / "two.json").write_text(json.dumps(file | {"sha256": "ab" * 32}))
    assert "sha256" in command("import", str(tmp_path / "two.json"), code=1).stderr
    (tmp_path / "three.json").write_text("{")
    assert "three.json" in command("import", str(tmp_path / "three.json"), code=1).stderr
    assert client.creature(file["sha256"]).identity == file["identity"]


def test_ctrl_c_leaves_the_run_going(address, client, run):
    # A shell's background jobs ignore SIGINT, and so would every process that they start.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    ours, theirs = os.openpty()
    watching = subprocess.Popen(
        [sys.executable, "-m", "microcosmos", "watch", run.id[:8]],
        env=os.environ | {"MICROCOSMOS_URL": address, "TERM": "xterm", "COLUMNS": "120"},
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    text = ""
    while "queued" not in text or "━" not in text:
        text += os.read(ours, 4096).decode(errors="replace")
    watching.send_signal(signal.SIGINT)
    with suppress(OSError):  # How a terminal ends.
        while more := os.read(ours, 4096):
            text += more.decode(errors="replace")
    os.close(ours)
    assert watching.wait(timeout=60) == 130
    assert "goes on without being watched" in text
    assert "Traceback" not in text
    assert client.run(run.id).status == "queued"


def test_the_doctor_warns_of_missing_workers(address):
    found = list(server(address, None))
    subjects = {one.subject for one in found if one.level == "ok"}
    assert subjects == {"server", "database", "disk", "Redis"}
    assert found[-1].level == "warning"
    assert found[0].found.endswith(f"answers at {address}")
    assert "WORKERS=n" in found[-1].advice


def test_the_doctor_names_a_lost_redis_and_asks_for_a_token(served, monkeypatch):
    found = list(server(served(redis_url="redis://127.0.0.1:1/0"), None))
    assert any(one.subject == "Redis" and one.level == "problem" for one in found)
    monkeypatch.delenv("MICROCOSMOS_TOKEN", raising=False)
    address = served(token=SecretStr("sesame"))
    assert [one.level for one in server(address, None)] == ["problem"]
    assert "problem" not in {one.level for one in server(address, "sesame")}
