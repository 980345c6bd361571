"""What the client does where the network, or what is at the other end, fails."""

import socket

import httpx
import pytest
from relay import other

from microcosmos.client import (
    Client,
    Conflict,
    NoAnswer,
    NotMicrocosmos,
    ServerError,
    connection,
    streaming,
)
from server.attempts.claim import claim


def test_a_request_whose_answer_is_lost_is_made_again_and_counts_once(
    relay, services, spec, hasty
):
    client = Client(relay.url)
    list(client.runs())
    relay.cut()
    relay.allowance = [1]  # The run is queued, and nobody is told.
    run = client.submit(spec)
    assert [one.id for one in client.runs()] == [run.id]
    sent = [ask for ask in relay.asked if ask.startswith(b"POST")]
    assert len(sent) == 2


def test_what_would_be_done_twice_is_not_sent_again(relay, run, hasty):
    client = Client(relay.url)
    mine = client.run(run.id)
    relay.cut()
    relay.allowance = [1]
    with pytest.raises(NoAnswer, match="broke off"):
        mine.extend(5)
    assert sum(b"/extend" in ask for ask in relay.asked) == 1


def test_events_go_on_behind_the_last_one(relay, services, run_id, report):
    client = Client(relay.url)
    attempt = claim(services, run_id, "worker")
    found = streaming.events(client.connection, str(run_id))
    assert next(found).kind == "beat"  # From here on.
    heard: list[int] = []
    for generation in range(1, 7):
        attempt.record(report(generation), float(generation))
        if generation == 3:
            relay.cut()
        while generation not in heard:
            event = next(found)
            if event.kind == "generation":
                heard.append(event.data["generation"])
    assert heard == [1, 2, 3, 4, 5, 6]
    assert any(b"last-event-id" in ask.lower() for ask in relay.asked)


def test_where_nobody_listens_it_is_said_what_to_do(hasty):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    expected = f"No server answers at http://127.0.0.1:{port}: start one with `make run`"
    with pytest.raises(NoAnswer, match=expected):
        list(Client(f"127.0.0.1:{port}").runs())
    assert sum(hasty) < 2  # A person waits.


HTML = {"Content-Type": "text/html"}


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ((200, HTML, b"<h1>Log in</h1>"), "answers 200 OK with a web page"),
        ((404, HTML, b"<h1>nginx</h1>"), "as no Microcosmos server does"),
        ((404, {"Content-Type": "application/json"}, b"{}"), "404 Not Found"),
        ((302, {"Location": "https://sso.example/"}, b""), "sends on to https://sso.example/"),
        ((200, {"Content-Type": "application/json"}, b"{"), "as no Microcosmos server does"),
    ],
)
def test_what_is_no_microcosmos_is_named_so(answer, said, hasty):
    with other(answer) as (url, _), pytest.raises(NotMicrocosmos, match=said):
        list(Client(url).runs())


PROBLEM = {"Content-Type": "application/problem+json"}


def test_who_is_busy_is_asked_again_when_it_says(hasty):
    empty = (200, {"Content-Type": "application/json"}, b'{"items": [], "next": null}')
    busy = (503, PROBLEM | {"Retry-After": "2"}, b'{"detail": "The database does not answer."}')
    with other(busy, busy, empty) as (url, asked):
        assert list(Client(url).runs()) == []
    assert (hasty, asked) == ([2.0, 2.0], ["GET"] * 3)


def test_patience_counts_how_long_a_silence_was(hasty, monkeypatch):
    clock, asked = [0.0], []

    def silent(request: httpx.Request) -> httpx.Response:
        asked.append(request)
        clock[0] += 20.0
        raise httpx.ReadTimeout("nothing came")

    monkeypatch.setattr(connection.time, "monotonic", lambda: clock[0])
    client = Client("http://box", patience=30.0, transport=httpx.MockTransport(silent))
    client.connection.answered = True
    with pytest.raises(NoAnswer, match="did not answer in time"):
        list(client.runs())
    assert len(asked) == 2


def test_patience_ends_with_the_servers_own_words(hasty):
    body = b'{"detail": "The database does not answer; try again."}'
    with other((503, PROBLEM | {"Retry-After": "4"}, body)) as (url, asked):
        with pytest.raises(ServerError, match="The database does not answer; try again"):
            list(Client(url, patience=10.0).runs())
        assert len(asked) == 3
    gateway = (502, HTML, b"Bad Gateway")
    said = "the server behind it is down or starting"
    with other(gateway) as (url, _), pytest.raises(NoAnswer, match=said):
        list(Client(url).runs())


@pytest.mark.parametrize(
    ("status", "body", "kind", "said"),
    [
        (409, b'{"detail": "It is running."}', Conflict, "It is running."),
        (500, b"{", ServerError, "answered 500 without a reason"),
        (
            422,
            b'{"detail": "No.", "errors": [{"field": "a.b", "message": "needs 1"}]}',
            ServerError,
            r"No; a\.b: needs 1\.",
        ),
    ],
)
def test_problems_are_sentences(status, body, kind, said):
    with other((status, PROBLEM, body)) as (url, _), pytest.raises(kind, match=said):
        Client(url).workers()


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("localhost:9", "http://localhost:9"),
        ("https://lab.example/micro/", "https://lab.example/micro"),
        ("http://127.0.0.1:8000/api/v1/", "http://127.0.0.1:8000"),
    ],
)
def test_addresses_are_taken_as_people_write_them(given, meant):
    assert Client(given).url == meant


@pytest.mark.parametrize("given", ["ftp://x", "http://", "http://x:99999"])
def test_what_is_no_address_is_refused(given):
    with pytest.raises(ValueError, match="`url` must be an address"):
        Client(given)


def test_a_proxy_of_the_environment_is_not_asked_for_this_machine(address, monkeypatch):
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    assert list(Client(address).runs()) == []
