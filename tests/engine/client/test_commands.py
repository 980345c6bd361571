"""Commands ask exactly for what they say."""

import json
from typing import Any

import httpx
import pytest
from rich.console import Console
from typer.testing import CliRunner

from microcosmos.cli import app, remote, specs
from microcosmos.client import NotFound, Run
from microcosmos.version import VERSION

SHA = "ab" * 32
TOKEN = {"id": "70ce0000-0000-4000-8000-000000000001", "name": "laptop", "scope": "write"}
SWEEP = {
    "id": "5eed0000-0000-4000-8000-000000000001",
    "name": None,
    "cases": [],
    "total": 6,
    "status_counts": {"queued": 6},
}


@pytest.fixture
def told(fake, record, monkeypatch):
    """Carries a command out: what it said, and asked a server that knows one of each."""
    monkeypatch.setenv("COLUMNS", "200")
    run = f"runs/{record['id']}"
    gone = record | {
        "status": "finished",
        "name": "Big Eel",
        "deleted_at": "2026-01-01T00:00:00Z",
    }
    preset = {
        "name": "demo",
        "spec": {"experiment": "quality-diversity", "world": {"width": 9}},
    }
    share = {"slug": "s1", "url": "http://fake/s/s1", "title": "[/x]", "expires_at": None}
    answers: dict[tuple[str, str], Any] = {
        ("GET", "experiments"): [{"experiment": "quality-diversity", "presets": [preset]}],
        ("GET", "runs"): {"items": [record], "next": None},
        ("GET", run): record,
        ("POST", "sweeps"): SWEEP,
        ("GET", f"sweeps/{SWEEP['id']}"): SWEEP,
        ("POST", f"sweeps/{SWEEP['id']}/pause"): SWEEP,
        ("GET", "sweeps"): {"items": [SWEEP], "next": None},
        ("POST", "shares"): share,
        ("GET", "shares"): [share],
        ("DELETE", "shares/s1"): httpx.Response(204),
        ("POST", "tokens"): TOKEN | {"secret": "once"},
        ("GET", "tokens"): [TOKEN],
        ("DELETE", f"tokens/{TOKEN['id']}"): httpx.Response(204),
        ("DELETE", run): gone,
        **{("POST", f"{run}/{do}"): record for do in ("extend", "fork", "restore", "pause")},
    }
    served = fake(answers)
    monkeypatch.setattr(remote, "Client", lambda *_: served.connect())

    def carry_out(*arguments: str, code: int = 0, **options: Any) -> Any:
        found = CliRunner().invoke(app, list(arguments), **options)
        assert found.exit_code == code, found.output
        return found, served.asked

    return carry_out


def test_a_sweep_is_submitted_with_its_grid(told):
    made, asked = told(
        "submit", "demo", "--seeds", "3", "--set", "world.width=12", "--set", "stop=null",
        "--sweep", "world.viscosity=0.05,0.1", "--sweep", 'body={"nodes": 8}',
        "--sweep", "control.encoding=[\"cppn\"]",
    )  # fmt: skip
    spec = {"experiment": "quality-diversity", "world": {"width": 12}, "stop": None}
    assert asked[-1].document == {
        "spec": spec,
        "seeds": 3,
        "grid": {
            "world.viscosity": [0.05, 0.1],
            "body": [{"nodes": 8}],
            "control.encoding": ["cppn"],
        },
    }
    assert made.stdout.strip() == SWEEP["id"]
    assert "A sweep of 6 runs" in made.stderr


def test_deleting_again_after_a_lost_answer_succeeds(fake, record):
    path, gone = f"runs/{record['id']}", record | {"deleted_at": "2026-01-01T00:00:00Z"}
    problem = {"content-type": "application/problem+json"}
    there = httpx.Response(404, headers=problem, json={"detail": "It is in the bin."})
    run = Run(fake({("DELETE", path): there, ("GET", path): gone}).client.connection, record)
    assert run.delete().record == gone
    never = fake({("DELETE", path): there, ("GET", path): record})
    with pytest.raises(NotFound):
        Run(never.client.connection, record).delete()


def test_the_version_is_told():
    assert CliRunner().invoke(app, ["--version"]).stdout.strip() == VERSION


def test_extending(told, record):
    _, asked = told("extend", "0f3c", "20")
    assert asked[-1][:3] == ("POST", f"runs/{record['id']}/extend", {"generations": 20})


def test_forking_elites_into_another_world(told, record):
    _, asked = told(
        "fork", "0f3c", "--elite", SHA, "--set", "world.viscosity=0.3", "--name", "thick"
    )
    patch = {"world": {"viscosity": 0.3}}
    expected = {"from": {"creatures": [SHA]}, "spec": patch, "name": "thick"}
    assert asked[-1][:3] == ("POST", f"runs/{record['id']}/fork", expected)
    assert told("fork", "0f3c", "--cells", "3,17")[1][-1].document["from"] == {"cells": [3, 17]}
    within = told("fork", "0f3c", "--region", "turning=0:1.5", "--generation", "4")[1][-1]
    assert within.document["from"] == {"region": {"turning": [0.0, 1.5]}}
    assert within.document["generation"] == 4
    assert told("fork", "0f3c", "--all")[1][-1].document["from"] == {"archive": True}


def test_deleting_asks_first(told, record):
    kept, asked = told("delete", "0f3c", input="n\n")
    assert "DELETE" not in {one.method for one in asked}
    assert "not deleted" in kept.stderr
    gone, asked = told("delete", "0f3c", input="y\n")
    assert asked[-1][:2] == ("DELETE", f"runs/{record['id']}")
    assert "Run 0f3c1a2b “Big Eel” is in the bin" in gone.stderr
    assert "microcosmos restore 0f3c1a2b" in gone.stderr
    _, asked = told("delete", "0f3c", "--yes")
    assert asked[-1].method == "DELETE"
    told("delete", "0f3c", input="", code=1)  # Nobody is there to ask.
    back, asked = told("restore", "0f3c")
    assert asked[-1][:2] == ("POST", f"runs/{record['id']}/restore")
    assert asked[-2].query["deleted"] == "true"
    assert "is restored" in back.stderr


def test_sharing(told, record):
    made, asked = told("share", SHA, "--title", "Eel", "--licence", "CC0-1.0", "--listed")
    expected = {"creature": SHA, "title": "Eel", "licence": "CC0-1.0", "listed": True}
    assert asked[-1][:3] == ("POST", "shares", expected)
    assert made.stdout.strip() == "http://fake/s/s1"
    _, asked = told("share", "0f3c", "--generation", "3")
    assert asked[-1].document == {"run": record["id"], "generation": 3, "listed": False}
    assert "http://fake/s/s1" in told("shares")[0].stdout
    _, asked = told("unshare", "http://fake/s/s1")
    assert asked[-1][:2] == ("DELETE", "shares/s1")


def test_tokens(told):
    made, asked = told("tokens", "create", "laptop", "--scope", "write")
    assert asked[-1][:3] == ("POST", "tokens", {"name": "laptop", "scope": "write"})
    assert made.stdout.strip() == "once"
    assert "laptop" in told("tokens", "list")[0].stdout
    assert json.loads(told("tokens", "list", "--json")[0].stdout) == [TOKEN]
    _, asked = told("tokens", "revoke", "70ce")
    assert asked[-1][:2] == ("DELETE", f"tokens/{TOKEN['id']}")


def test_names_are_never_read_as_markup(told, record, monkeypatch):
    """Nor is an id broken where there is little room."""
    monkeypatch.setitem(TOKEN, "name", "lap[/top]")
    monkeypatch.setitem(record, "name", "swims [bold]far[/nowhere]")
    for command, name in (("tokens list", TOKEN["name"]), ("runs", record["name"])):
        assert name in told(*command.split())[0].stdout
    monkeypatch.setattr(remote, "stdout", lambda: Console(width=40))
    assert record["id"][:8] in told("runs")[0].stdout


def test_an_id_may_be_a_sweeps(told, record):
    assert told("pause", "0f3c")[1][-1].path == f"runs/{record['id']}/pause"
    paused, asked = told("pause", "5eed")
    assert asked[-2][:2] == ("POST", f"sweeps/{SWEEP['id']}/pause")
    assert "Sweep 5eed0000: 6 queued" in paused.stderr
    missing, _ = told("pause", "ffff", code=1)
    said = "No run or sweep at http://fake has an id that begins with ffff."
    assert missing.stderr.strip() == said


def test_an_id_that_may_be_a_runs_or_a_sweeps_is_refused(told, record, monkeypatch):
    """To cancel cannot be undone."""
    monkeypatch.setitem(SWEEP, "id", record["id"][:4] + SWEEP["id"][4:])
    refused, asked = told("cancel", "0f3c", code=1)
    assert {one.method for one in asked} == {"GET"}
    assert f"run {record['id']} and of sweep {SWEEP['id']}" in refused.stderr


@pytest.mark.parametrize(
    ("text", "value"),
    [("3", 3), ("0.5", 0.5), ("true", True), ("null", None), ("ours", "ours"), ("[1]", [1])],
)
def test_values_are_json_or_text(text, value):
    assert specs.applied({}, [f"a.b={text}"]) == {"a": {"b": value}}


def test_items_of_a_list_are_set_by_number():
    spec = {"archive": {"descriptors": [{"bins": 5}, {"bins": 6}]}}
    changed = specs.applied(spec, ["archive.descriptors.1.bins=9"])
    assert changed["archive"]["descriptors"] == [{"bins": 5}, {"bins": 9}]
    assert spec["archive"]["descriptors"][1]["bins"] == 6
