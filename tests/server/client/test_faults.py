"""The client when the network, the server or the disk fails."""

import errno
import hashlib
import os
import socket
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from relay import foreign_server

from microcosmos.client import (
    Client,
    Conflict,
    NoAnswer,
    NotMicrocosmos,
    ServerError,
    files,
    polling,
)
from microcosmos_server.attempts.claim import claim


def test_a_request_whose_answer_is_lost_is_repeated_safely(relay, services, spec, no_sleep):
    client = Client(relay.url)
    list(client.runs())
    relay.cut()
    relay.allowance = [1]  # The run is queued, but the answer is lost.
    run = client.submit(spec)
    assert [one.id for one in client.runs()] == [run.id]
    sent = [ask for ask in relay.asked if ask.startswith(b"POST")]
    assert len(sent) == 2


def test_unsafe_requests_are_not_repeated(relay, run, no_sleep):
    client = Client(relay.url)
    mine = client.run(run.id)
    relay.cut()
    relay.allowance = [1]
    with pytest.raises(NoAnswer, match="broke off"):
        mine.extend(5)
    assert sum(b"/extend" in ask for ask in relay.asked) == 1


def test_events_continue_after_the_last_id(relay, run_id, record, attempt):
    client = Client(relay.url)
    found = polling.events(client.connection, str(run_id))
    assert next(found).kind == "start"  # From here on.
    generations: list[int] = []
    for generation in range(1, 7):
        record(generation, seconds=float(generation))
        if generation == 3:
            relay.cut()
        while generation not in generations:
            event = next(found)
            if event.kind == "generation":
                generations.append(event.data["generation"])
    assert generations == [1, 2, 3, 4, 5, 6]
    assert any(b"last-event-id" in ask.lower() for ask in relay.asked)


def test_an_absent_server_is_answered_with_advice(no_sleep):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    expected = f"No server answers at http://127.0.0.1:{port}: start one with `make run`"
    with pytest.raises(NoAnswer, match=expected):
        list(Client(f"127.0.0.1:{port}").runs())
    assert sum(no_sleep) < 2  # A person waits.


HTML = {"Content-Type": "text/html"}


PROBLEM = {"Content-Type": "application/problem+json"}


def test_a_busy_server_is_asked_again_after_its_delay(no_sleep):
    empty = (200, {"Content-Type": "application/json"}, b'{"items": [], "next": null}')
    busy = (503, PROBLEM | {"Retry-After": "2"}, b'{"detail": "The database does not answer."}')
    with foreign_server(busy, busy, empty) as (url, asked):
        assert list(Client(url).runs()) == []
    assert (no_sleep, asked) == ([2.0, 2.0], ["GET"] * 3)


@pytest.mark.parametrize("delay", ["soon", "Tue, 03 Jun 2008 11:05:30 +99999999999999999"])
def test_a_delay_that_is_none_counts_for_nothing(delay, no_sleep):
    empty = (200, {"Content-Type": "application/json"}, b'{"items": [], "next": null}')
    busy = (503, PROBLEM | {"Retry-After": delay}, b'{"detail": "No."}')
    with foreign_server(busy, empty) as (url, asked):
        assert list(Client(url).runs()) == []
    assert (len(no_sleep), asked) == (1, ["GET"] * 2)


def test_patience_ends_with_the_servers_own_words(no_sleep):
    body = b'{"detail": "The database does not answer; try again."}'
    with foreign_server((503, PROBLEM | {"Retry-After": "4"}, body)) as (url, asked):
        with pytest.raises(ServerError, match="The database does not answer; try again"):
            list(Client(url, patience=10.0).runs())
        assert len(asked) == 3
    gateway = (502, HTML, b"Bad Gateway")
    message = "the server behind it is down or starting"
    with foreign_server(gateway) as (url, _), pytest.raises(NoAnswer, match=message):
        list(Client(url).runs())


@pytest.mark.parametrize(
    ("status", "body", "kind", "message"),
    [
        (409, b'{"detail": "It is running."}', Conflict, "It is running."),
        (500, b"{", ServerError, "answered 500 without a reason"),
        (
            422,
            b'{"detail": "No.", "errors": [{"field": "a.b", "reason": "needs 1"}]}',
            ServerError,
            r"No; a\.b: needs 1\.",
        ),
    ],
)
def test_problems_are_sentences(status, body, kind, message):
    with (
        foreign_server((status, PROBLEM, body)) as (url, _),
        pytest.raises(kind, match=message),
    ):
        Client(url).workers()


def test_addresses_are_normalised_and_malformed_ones_refused():
    for given, meant in {
        "localhost:9": "http://localhost:9",
        "https://lab.example/micro/": "https://lab.example/micro",
        "http://127.0.0.1:8000/api/v1/": "http://127.0.0.1:8000",
    }.items():
        assert Client(given).url == meant
    malformed = ("ftp://x", "http://", "http://x:99999", "999.1.1.1:8000", "a..b", "a\x01b")
    for given in malformed:
        with pytest.raises(ValueError, match="`url` must be an address"):
            Client(given)


@pytest.mark.parametrize(
    "given",
    [
        *("http://bob:hunter2@box", "bob:hunter2@box:9/runs?x", "http:/bob:hunter2@box"),
        *("http://bob:x/hunter2@box", "http://bob:x#hunter2@box", "https:///bob:hunter2@box"),
    ],
)
def test_an_address_with_a_password_is_refused_and_not_shown(given):
    """Links and errors would show it, and the library would send it in place of the token."""
    with pytest.raises(ValueError, match=r"`url` must be an address") as caught:
        Client(given, "token")
    assert "hunter2" not in str(caught.value)


@pytest.mark.parametrize("token", ["abcsecret\r", "secret\n", "sécret", "my secret"])
def test_a_token_that_no_header_can_carry_is_refused_and_not_shown(token):
    with pytest.raises(ValueError, match="`token` must be ASCII letters") as caught:
        Client("http://box", token)
    assert "ecret" not in str(caught.value)
    assert caught.value.__cause__ is None


@pytest.mark.parametrize("proxy", ["foo:bar", "foo://u:hunter2@x", "http://1.2.3.999"])
def test_a_malformed_proxy_is_named_without_its_password(proxy, monkeypatch):
    monkeypatch.setenv("HTTP_PROXY", proxy)
    with pytest.raises(ValueError, match=r"HTTP_PROXY.*must be addresses") as caught:
        Client("http://box")
    assert "hunter2" not in str(caught.value)


def test_an_answer_that_is_not_compressed_as_it_says_is_foreign(tmp_path):
    """For lists, events and downloads."""
    headers = {"Content-Encoding": "gzip"}
    for status in (200, 500):
        with foreign_server((status, headers, b"no gzip")) as (url, _):
            client = Client(url)
            with pytest.raises(NotMicrocosmos, match="not in the encoding"):
                list(client.runs())
            with pytest.raises(NotMicrocosmos, match="not in the encoding"):
                next(client.events())
            expected = "without its hash" if status == 200 else "not in the encoding"
            with pytest.raises(NotMicrocosmos, match=expected):
                files.fetch(client.connection, "x", tmp_path / "x")


def test_loopback_requests_bypass_the_proxy(address, monkeypatch):
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    assert list(Client(address).runs()) == []


@pytest.fixture
def archive(services, run_id, report) -> bytes:
    """The run's checkpoint, larger than one packet of the relay."""
    content = os.urandom(3_000_000)
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    attempt.save(1, content)
    return content


def test_a_download_goes_on_where_it_broke_off(relay, run_id, archive, tmp_path, no_sleep):
    progress: list[tuple[int, int]] = []
    relay.allowance = [1 << 40, 1_000_000, 1_000_000]
    run = Client(relay.url).run(str(run_id))
    relay.cut()
    relay.asked.clear()
    to = tmp_path / "run.h5"
    found = files.fetch(
        run._connection, f"runs/{run_id}/archive.h5", to, lambda *now: progress.append(now)
    )
    assert found.read_bytes() == archive
    ranges = [ask for ask in relay.asked if b"range: bytes=" in ask.lower()]
    assert len(ranges) == 2
    assert all(b"if-range" in ask.lower() for ask in ranges)
    assert {whole for _, whole in progress} == {len(archive)}
    assert [path.name for path in tmp_path.iterdir() if "part" in path.name] == []
    relay.asked.clear()
    assert run.pull(to).read_bytes() == archive
    assert b"If-None-Match" in relay.asked[-1]  # Nothing is fetched twice.


def test_downloads_of_one_file_at_once_take_turns(client, run_id, archive, tmp_path):
    to, link = tmp_path / "run.h5", tmp_path / "link.h5"
    link.symlink_to(to)
    with ThreadPoolExecutor(6) as pool:
        runs = [client.run(str(run_id))] * 6
        found = list(pool.map(lambda run, path: run.pull(path), runs, [to, link] * 3))
    assert found == [to, link] * 3
    assert (to.read_bytes(), link.is_symlink()) == (archive, True)
    assert set(tmp_path.iterdir()) == {to, link}


def test_a_pipe_is_not_replaced_by_a_download(client, run_id, archive, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FileExistsError, match="a file is needed, got"):
        client.run(str(run_id)).pull(tmp_path / "pipe")
    assert (tmp_path / "pipe").is_fifo()


def test_partial_files_are_used_only_if_intact(client, run_id, archive, tmp_path):
    run, to = client.run(str(run_id)), tmp_path / "run.h5"
    old, name = (hashlib.sha256(one).hexdigest() for one in (b"an older checkpoint", archive))
    (tmp_path / f".run.h5.{old}.part").write_bytes(b"an older")
    assert run.pull(to).read_bytes() == archive, "a changed file is downloaded from the start"
    assert list(tmp_path.glob("*.part")) + list(tmp_path.glob(".*.part")) == []
    to.unlink()
    part = tmp_path / f".run.h5.{name}.part"
    part.write_bytes(b"x" * 100)
    with pytest.raises(ServerError, match="damaged on its way"):
        run.pull(to)
    assert not to.exists()
    assert run.pull(to).read_bytes() == archive
    to.unlink()
    part.write_bytes(archive)
    assert run.pull(to).read_bytes() == archive, "a complete part is moved into place"


def test_a_full_disk_is_reported_with_the_file(no_sleep, tmp_path, monkeypatch):
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    name = hashlib.sha256(b"whole").hexdigest()
    answer = httpx.Response(200, headers={"etag": f'"{name}"'}, content=iter([b"whole"]))
    client = Client("http://box", transport=httpx.MockTransport(lambda _: answer))
    with pytest.raises(OSError, match=rf"No space left on device: '.*\.x\.{name}\.part'"):
        files.fetch(client.connection, "x", tmp_path / "x")
