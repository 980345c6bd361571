"""Programs that are no Microcosmos server, and runs that cannot be compared yet."""

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
        transport = httpx.MockTransport(lambda _: httpx.Response(200, json=document))
        monkeypatch.setattr(
            httpx, "Client", lambda **given: connect(**given | {"transport": transport})
        )

    return serve


@pytest.mark.parametrize("answer", ANSWERS, ids=str)
@pytest.mark.parametrize(
    ("command", "code"),
    [
        (f"watch {ID}", 1),
        (f"compare a={ID} b={ID}", 2),
        (f"reproject {ID}", 1),
        (f"export {ID} --as parquet", 2),
        (f"delete {ID} -y", 1),
        (f"pull {ID}", 1),
    ],
)
def test_another_program_is_recognised(command, code, answer, foreign):
    foreign(answer)
    done = CliRunner().invoke(app, [*command.split(), "--url", "http://other"])
    assert isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == code, done.output
    assert "as no Microcosmos server" in done.stderr


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


def test_a_run_without_a_generation_is_told_from_one_without_an_archive(fake, record):
    waiting = record | {"status": "queued", "generation": 0, "qd_score": None}
    search = waiting | {"spec": {"experiment": "quality-diversity", "search": {}}}
    with pytest.raises(ValueError, match="a generation is needed; the run is queued without"):
        groups.record(fake({}).run(search))
    gaits = waiting | {"experiment": "gaits", "spec": {"experiment": "gaits"}}
    with pytest.raises(ValueError, match="a search with an archive is needed, got gaits"):
        groups.record(fake({}).run(gaits))
