"""Programs that are no Microcosmos server, and runs that cannot be compared yet."""

import json

import httpx
import pytest
from typer.testing import CliRunner

from microcosmos.cli import app, groups
from microcosmos.client import Client, NotMicrocosmos

ID = "0f3c1a2b-0000-4000-8000-000000000001"
ANSWERS = [
    {"hello": "world"},
    {"items": None},
    {"items": [{"hello": 1}]},
    [3],
    [],
    "hi",
    None,
    3,
]


@pytest.fixture
def foreign(monkeypatch):
    """A function that lets commands meet a server that answers everything with one document."""
    connect = httpx.Client

    def serve(document):
        kind = {"content-type": "application/json"}
        raw = document if isinstance(document, bytes) else json.dumps(document).encode()
        transport = httpx.MockTransport(
            lambda _: httpx.Response(200, headers=kind, content=raw)
        )
        monkeypatch.setattr(
            httpx, "Client", lambda **given: connect(**given | {"transport": transport})
        )

    return serve


@pytest.mark.parametrize("answer", ANSWERS, ids=str)
@pytest.mark.parametrize(
    "command",
    [
        f"watch {ID}",
        f"compare a={ID} b={ID}",
        f"reproject {ID}",
        f"export {ID} --as parquet",
        f"delete {ID} -y",
        f"pull {ID}",
    ],
)
def test_another_program_is_recognised(command, answer, foreign):
    foreign(answer)
    done = CliRunner().invoke(app, [*command.split(), "--url", "http://other"])
    assert isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == 1, done.output
    assert "as no Microcosmos server" in done.stderr


SHARES = ["evolve", "submit", "import", "import --all"]


@pytest.mark.parametrize("answer", [*ANSWERS, {"creatures": 5}, {"run": 5}], ids=str)
@pytest.mark.parametrize("command", SHARES)
def test_another_program_at_the_address_of_a_share_is_recognised(command, answer, foreign):
    foreign(answer)
    done = CliRunner().invoke(app, [*command.split(), "https://other/s/abc"])
    assert isinstance(done.exception, SystemExit), done.exception
    # An object might be a creature file, so its first missing field is named.
    told = command == "import" and isinstance(answer, dict)
    words = "`identity` needs a value" if told else "https://other answers"
    assert (done.exit_code, words in done.stderr) == (1, True), done.output


@pytest.mark.parametrize("command", SHARES)
def test_a_share_at_an_address_with_a_password_is_refused_and_not_shown(command):
    given = [*command.split(), "https://bob:hunter2@other/s/abc"]
    done = CliRunner().invoke(app, given)
    assert isinstance(done.exception, SystemExit), done.exception
    assert "without a user name or password" in done.stderr
    assert "hunter2" not in done.output


@pytest.mark.parametrize("answer", [one for one in ANSWERS if one != []], ids=str)
@pytest.mark.parametrize("command", ["runs", "watch 0f3c", "watch --last", "submit demo"])
def test_lists_of_another_program_are_recognised(command, answer, foreign):
    foreign(answer)
    done = CliRunner().invoke(app, [*command.split(), "--url", "http://other"])
    assert done.exit_code == 1, done.exception
    assert "http://other answers" in done.stderr
    assert "as no Microcosmos server" in done.stderr


def test_a_field_that_an_answer_lacks_is_named(foreign):
    foreign({"items": [{"id": ID}]})
    (run,) = Client("http://other").runs()
    with pytest.raises(NotMicrocosmos, match="http://other answers without the field `status`"):
        _ = run.status


DEEP = b"[" * 100_000
ENDLESS = {"items": [{"slug": "a", "url": "/s/a"}], "next": "again"}


@pytest.mark.parametrize(
    ("command", "answer", "words"),
    [
        ("runs", {"items": [{"progress": None}]}, "answers with None as the field `progress`"),
        ("runs", {"items": [{"best": "high"}]}, "answers with 'high' as the field `best`"),
        (f"watch {ID}", {"status": None}, "answers with None as the field `status`"),
        (f"sweep {ID}", {"status_counts": []}, "answers with [] as the field `status_counts`"),
        ("pull 0f3c", {"items": [{"id": None}]}, "answers with None as the field `id`"),
        ("tokens create a", None, "answers with None in place of a record"),
        ("tokens create a", {}, "answers without the field `secret`"),
        (f"choices {ID}", [], "answers with [] in place of a record"),
        ("runs", DEEP, "answers 200 OK with application/json"),
        ("shares", ENDLESS, "answers with a list that does not end"),
        ("shares", {"items": [], "next": "more"}, "answers with a list that does not end"),
    ],
    ids=lambda given: str(given)[:40],
)
def test_answers_that_no_server_of_ours_gives_are_told(command, answer, words, foreign):
    foreign(answer)
    done = CliRunner().invoke(app, [*command.split(), "--url", "http://other"])
    assert isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == 1, done.output
    assert words in done.stderr


@pytest.mark.parametrize("data", [b"{", b"[1]", b'{"progress": null}', DEEP], ids=len)
def test_an_event_that_no_server_of_ours_sends_is_told(data):
    stream = b"event: run\ndata: " + data + b"\n\n"
    transport = httpx.MockTransport(lambda _: httpx.Response(200, content=stream))
    with pytest.raises(NotMicrocosmos, match="http://other answers with"):
        next(Client("http://other", transport=transport).events())


def test_a_run_without_a_generation_is_told_from_one_without_an_archive(fake, record):
    waiting = record | {"status": "queued", "generation": 0, "qd_score": None}
    search = waiting | {"spec": {"experiment": "quality-diversity", "search": {}}}
    with pytest.raises(ValueError, match="a generation is needed; the run is queued without"):
        groups.record(fake({}).run(search))
    gaits = waiting | {"experiment": "gaits", "spec": {"experiment": "gaits"}}
    with pytest.raises(ValueError, match="a search with an archive is needed, got gaits"):
        groups.record(fake({}).run(gaits))
