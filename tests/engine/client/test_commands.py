"""Commands send exactly the requests that they describe."""

import json
from typing import Any

import httpx
import pytest
import typer
from rich.console import Console
from typer.testing import CliRunner

from microcosmos.cli import app, remote, specs
from microcosmos.client import NotFound, Sweep, polling
from microcosmos.client.sweep import Summary
from microcosmos.version import VERSION

RUN = "0f3c1a2b-0000-4000-8000-000000000001"
SHA = "ab" * 32
TOKEN = {"id": "70ce0000-0000-4000-8000-000000000001", "name": "laptop", "scope": "write"}
SWEEP = {"id": "5eed0000-0000-4000-8000-000000000001", "name": None, "cases": []}
SWEEP |= {"total": 6, "status_counts": {"queued": 6}}


DELETED = {"deleted_at": "2026-01-01T00:00:00Z"}


@pytest.fixture
def command(fake, record, monkeypatch):
    """A function that runs a command; it returns its output and the server's requests."""
    monkeypatch.setenv("COLUMNS", "200")
    run = f"runs/{record['id']}"
    gone = record | DELETED | {"status": "finished", "name": "Big Eel"}
    spec = {"experiment": "quality-diversity", "world": {"width": 9}}
    preset = {"name": "demo", "spec": spec}
    share = {"slug": "s1", "url": "http://fake/s/s1", "title": "[/x]", "expires_at": None}
    answers: dict[tuple[str, str], Any] = {
        ("GET", "experiments"): [{"experiment": "quality-diversity", "presets": [preset]}],
        ("GET", "runs"): {"items": [record], "next": None},
        ("GET", run): record,
        ("GET", f"{run}/generations"): {name: [] for name in polling.CURVES},
        ("POST", "sweeps"): SWEEP,
        ("GET", f"sweeps/{SWEEP['id']}"): SWEEP,
        ("POST", f"sweeps/{SWEEP['id']}/pause"): SWEEP,
        ("DELETE", f"sweeps/{SWEEP['id']}"): httpx.Response(204),
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
        done = CliRunner().invoke(app, list(arguments), **options)
        assert done.exit_code == code, done.output
        return done, served.requests

    return carry_out


def test_a_sweep_is_submitted_with_its_grid(command):
    made, requests = command(
        "submit", "demo", "--seeds", "3", "--set", "world.width=12", "--set", "stop=null",
        "--sweep", "world.viscosity=0.05,0.1", "--sweep", 'body={"nodes": 8}',
        "--sweep", "control.encoding=[\"cppn\"]",
    )  # fmt: skip
    spec = {"experiment": "quality-diversity", "world": {"width": 12}, "stop": None}
    grid = {"world.viscosity": [0.05, 0.1], "body": [{"nodes": 8}]}
    grid["control.encoding"] = ["cppn"]
    assert requests[-1].document == {"spec": spec, "seeds": 3, "grid": grid}
    assert made.stdout.strip() == SWEEP["id"]
    assert "A sweep of 6 runs" in made.stderr


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("submit demo --sweep a.b=1 --sweep a.b=2", "--sweep needs a field once"),
        ("fork 0f3c --region a=0:1 --region a=2:3", "--region needs an axis once; got a twice"),
        ("submit demo --set a.b=NaN", "a.b needs finite numbers; got NaN"),
        ("submit demo --set a.b=1e400", "a.b needs finite numbers; got 1e400"),
        ("submit demo --set a.b=[1,-Infinity]", "a.b needs finite numbers; got [1,-Infinity]"),
        ("submit demo --sweep a.b=NaN,1", "a.b needs finite numbers; got NaN"),
    ],
)
def test_fields_that_cannot_be_sent_are_refused_by_name(given, words, command):
    refused, requests = command(*given.split(), code=2)
    assert words in " ".join(refused.stderr.split())
    assert {one.method for one in requests} <= {"GET"}


@pytest.mark.parametrize("days", ["3000000", "1e9", "nan", "inf", "0", "-1"])
@pytest.mark.parametrize("given", [f"share {SHA}", "tokens create laptop"])
def test_days_that_do_not_end_are_refused(given, days, command):
    refused, requests = command(*given.split(), f"--days={days}", code=1)
    expected = f"`days` must be above 0 and end before the year 10000, got {float(days)}"
    assert refused.stderr.strip() == expected
    assert not requests


def test_a_sweep_of_which_nothing_can_be_deleted_is_an_error(command):
    kept, _ = command("delete", "5eed", "-y", code=1)
    expected = "Sweep 5eed0000: 6 queued; queued and running runs are kept: cancel them first"
    assert kept.stderr.strip() == expected


def test_deleting_again_after_a_lost_answer_succeeds(fake, record):
    path, gone = f"runs/{record['id']}", record | DELETED
    problem = {"content-type": "application/problem+json"}
    there = httpx.Response(404, headers=problem, json={"detail": "It is in the bin."})
    run = fake({("DELETE", path): there, ("GET", path): gone}).run(record)
    assert run.delete().record == gone
    run = fake({("DELETE", path): there, ("GET", path): record}).run(record)
    with pytest.raises(NotFound):
        run.delete()


def test_the_version_is_told():
    assert CliRunner().invoke(app, ["--version"]).stdout.strip() == VERSION


def test_forking_elites_into_another_world(command, record):
    _, requests = command(
        "fork", "0f3c", "--elite", SHA, "--set", "world.viscosity=0.3", "--name", "thick"
    )
    patch = {"world": {"viscosity": 0.3}}
    expected = {"from": {"creatures": [SHA]}, "spec": patch, "name": "thick"}
    assert requests[-1][:3] == ("POST", f"runs/{record['id']}/fork", expected)
    cells = command("fork", "0f3c", "--cells", "3,17")[1][-1]
    assert cells.document["from"] == {"cells": [3, 17]}
    within = command("fork", "0f3c", "--region", "turning=0:1.5", "--generation", "4")[1][-1]
    assert within.document["from"] == {"region": {"turning": [0.0, 1.5]}}
    assert within.document["generation"] == 4
    assert command("fork", "0f3c", "--all")[1][-1].document["from"] == {"archive": True}


def test_deleting_asks_first(command, record):
    kept, requests = command("delete", "0f3c", input="n\n")
    assert "DELETE" not in {one.method for one in requests}
    assert "not deleted" in kept.stderr
    gone, requests = command("delete", "0f3c", input="y\n")
    assert requests[-1][:2] == ("DELETE", f"runs/{record['id']}")
    assert "Run 0f3c1a2b “Big Eel” is in the bin" in gone.stderr
    assert "microcosmos restore 0f3c1a2b" in gone.stderr
    _, requests = command("delete", "0f3c", "--yes")
    assert requests[-1].method == "DELETE"
    command("delete", "0f3c", input="", code=1)  # Nobody is there to ask.
    back, requests = command("restore", "0f3c")
    assert requests[-1][:2] == ("POST", f"runs/{record['id']}/restore")
    assert requests[-2].query["deleted"] == "true"
    assert "is restored" in back.stderr


def test_sharing(command, record):
    made, requests = command("share", SHA, "--title", "Eel", "--licence", "CC0-1.0", "--listed")
    expected = {"creature": SHA, "title": "Eel", "licence": "CC0-1.0", "listed": True}
    assert requests[-1][:3] == ("POST", "shares", expected)
    assert made.stdout.strip() == "http://fake/s/s1"
    _, requests = command("share", "0f3c", "--generation", "3")
    assert requests[-1].document == {"run": record["id"], "generation": 3, "listed": False}
    assert "http://fake/s/s1" in command("shares")[0].stdout
    _, requests = command("unshare", "http://fake/s/s1")
    assert requests[-1][:2] == ("DELETE", "shares/s1")


def test_tokens(command):
    made, requests = command("tokens", "create", "laptop", "--scope", "write")
    assert requests[-1][:3] == ("POST", "tokens", {"name": "laptop", "scope": "write"})
    assert made.stdout.strip() == "once"
    assert command("tokens", "create", "phone")[1][-1].document["scope"] == "read"
    assert "laptop" in command("tokens", "list")[0].stdout
    assert json.loads(command("tokens", "list", "--json")[0].stdout) == [TOKEN]
    _, requests = command("tokens", "revoke", "70ce")
    assert requests[-1][:2] == ("DELETE", f"tokens/{TOKEN['id']}")


def test_names_are_never_read_as_markup_and_ids_never_broken(command, record, monkeypatch):
    monkeypatch.setitem(TOKEN, "name", "lap[/top]")
    monkeypatch.setitem(record, "name", "swims [bold]far[/nowhere]")
    for words, name in (("tokens list", TOKEN["name"]), ("runs", record["name"])):
        assert name in command(*words.split())[0].stdout
    monkeypatch.setattr(remote, "stdout", lambda: Console(width=40))
    assert record["id"][:8] in command("runs")[0].stdout


def test_other_peoples_text_cannot_act_on_a_terminal(command, record):
    shown = r"evil\u001b]0;t\u001b\ \u202ewo\u000alines"
    record["name"] = "evil\x1b]0;t\x1b\\ \u202ewo\nlines"
    assert shown in command("runs")[0].stdout
    assert f"“{shown}”: running. Delete?" in command("delete", "0f3c", input="n")[0].stderr
    assert f"“{shown}”: running" in command("pause", "0f3c")[0].stderr
    text = command("runs", "--json")[0].stdout
    assert not set("\x1b\u202e") & set(text)
    assert json.loads(text)[0]["name"] == record["name"]


def test_a_record_stays_json_while_its_run_is_watched(command, record):
    record["status"] = "finished"
    done, _ = command("extend", "0f3c", "5", "--json", "--watch")
    assert json.loads(done.stdout) == record
    assert "finished" in done.stderr
    assert not command("watch", "0f3c")[0].stdout


def test_a_table_of_a_sweep_rounds_no_value_of_a_case(command, monkeypatch):
    final = {"median": 3.14159, "low": 3.0, "high": 3.25}
    cases = [
        {"values": {"a.b": x, "body": {"nodes": 8}}, "members": [], "finals": {"best": final}}
        for x in (0.100049, 0.100041)
    ]
    rows = [{"a.b": 0.100049, "best": None, "run": RUN}]
    monkeypatch.setattr(Sweep, "summary", lambda _: Summary(cases))
    monkeypatch.setattr(Sweep, "rows", lambda _: rows)
    text = command("sweep", "5eed")[0].stdout
    assert "0.100049" in text
    assert "0.100041" in text
    assert text.count("{'nodes': 8}") == 2
    assert text.count("3.142 (3 to 3.25)") == 2
    assert "0.100049" in command("sweep", "5eed", "--runs")[0].stdout
    assert json.loads(command("sweep", "5eed", "--runs", "--json")[0].stdout) == rows


def test_a_spec_is_read_from_standard_input(command):
    _, requests = command("submit", "-", "--seeds", "2", input='{"seed": 3}')
    assert requests[-1].document["spec"] == {"seed": 3}
    refused, _ = command("submit", "-", input="[]", code=1)
    assert refused.stderr.strip() == "standard input needs a spec as a JSON object; got []"


def test_an_id_may_be_a_sweeps(command, record):
    assert command("pause", "0f3c")[1][-1].path == f"runs/{record['id']}/pause"
    paused, requests = command("pause", "5eed")
    assert requests[-2][:2] == ("POST", f"sweeps/{SWEEP['id']}/pause")
    assert "Sweep 5eed0000: 6 queued" in paused.stderr
    missing, _ = command("pause", "ffff", code=1)
    message = "No run or sweep at http://fake has an id that begins with ffff."
    assert missing.stderr.strip() == message


def test_an_id_that_may_be_a_runs_or_a_sweeps_is_refused(command, record, monkeypatch):
    """To cancel cannot be undone."""
    monkeypatch.setitem(SWEEP, "id", record["id"][:4] + SWEEP["id"][4:])
    refused, requests = command("cancel", "0f3c", code=1)
    assert {one.method for one in requests} == {"GET"}
    assert f"run {record['id']} and of sweep {SWEEP['id']}" in refused.stderr


@pytest.mark.parametrize(
    ("text", "value"),
    [("3", 3), ("0.5", 0.5), ("true", True), ("null", None), ("ours", "ours"), ("[1]", [1])],
)
def test_values_are_json_or_text(text, value):
    assert specs.applied({}, [f"a.b={text}"]) == {"a": {"b": value}}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.05,ours", [0.05, "ours"]),
        ("[1, 2]", [1, 2]),
        ('{"a": 1, "b": 2}', [{"a": 1, "b": 2}]),
        ('"a,b"', ["a,b"]),
        ("7", [7]),
        ("ours", ["ours"]),
    ],
)
def test_commas_part_the_values_of_a_sweep_but_no_json(text, values):
    assert specs.grid([f"a.b={text}"]) == {"a.b": values}


@pytest.mark.parametrize("setting", ["a.0.x=1", "b.x=1", "a.0.x.y=1"])
def test_a_number_has_no_fields(setting):
    with pytest.raises(typer.BadParameter, match=r"has no fields; it is 0\.5"):
        specs.applied({"a": [0.5], "b": 0.5}, [setting])


def test_items_of_a_list_are_set_by_number():
    spec = {"archive": {"descriptors": [{"bins": 5}, {"bins": 6}]}}
    changed = specs.applied(spec, ["archive.descriptors.1.bins=9"])
    assert changed["archive"]["descriptors"] == [{"bins": 5}, {"bins": 9}]
    assert spec["archive"]["descriptors"][1]["bins"] == 6
