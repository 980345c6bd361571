"""Downloads that break off, are given up, damaged, or find no room."""

import errno
import hashlib
import os

import httpx
import pytest

from microcosmos.client import (
    Client,
    NoAnswer,
    ServerError,
    files,
)
from server.attempts.claim import claim


@pytest.fixture
def archive(services, run_id, report) -> bytes:
    """What the run's checkpoint holds, larger than a relay hands on at once."""
    content = os.urandom(3_000_000)
    attempt = claim(services, run_id, "worker")
    attempt.record(report(1), 1.0)
    attempt.save(1, content)
    return content


def test_a_download_goes_on_where_it_broke_off(relay, run_id, archive, tmp_path, hasty):
    told: list[tuple[int, int]] = []
    relay.allowance = [1 << 40, 1_000_000, 1_000_000]
    run = Client(relay.url).run(str(run_id))
    relay.cut()
    relay.asked.clear()
    to = tmp_path / "run.h5"
    found = files.fetch(
        run._connection, f"runs/{run_id}/archive.h5", to, lambda *now: told.append(now)
    )
    assert found.read_bytes() == archive
    ranges = [ask for ask in relay.asked if b"range: bytes=" in ask.lower()]
    assert len(ranges) == 2
    assert all(b"if-range" in ask.lower() for ask in ranges)
    assert {whole for _, whole in told} == {len(archive)}
    assert [path.name for path in tmp_path.iterdir() if "part" in path.name] == []
    relay.asked.clear()
    assert run.pull(to).read_bytes() == archive
    assert b"If-None-Match" in relay.asked[-1]  # Nothing is fetched twice.


def test_a_download_that_is_given_up_is_taken_up_later(relay, run_id, archive, tmp_path, hasty):
    run = Client(relay.url).run(str(run_id))
    relay.cut()
    relay.allowance = [1_000_000] + [50] * 20
    to = tmp_path / "run.h5"
    with pytest.raises(NoAnswer, match="broke off"):
        run.pull(to)
    (part,) = tmp_path.glob(".run.h5.*.part")
    had = part.stat().st_size
    assert 0 < had < len(archive)
    relay.allowance = []
    relay.asked.clear()
    assert run.pull(to).read_bytes() == archive
    assert f"bytes={had}-".encode() in b"".join(relay.asked)


def test_a_file_that_changed_meanwhile_is_fetched_anew(
    client, services, run_id, archive, report, tmp_path
):
    old = hashlib.sha256(b"an older checkpoint").hexdigest()
    (tmp_path / f".run.h5.{old}.part").write_bytes(b"an older")
    run = client.run(str(run_id))
    assert run.pull(tmp_path / "run.h5").read_bytes() == archive
    assert list(tmp_path.glob("*.part")) + list(tmp_path.glob(".*.part")) == []


def test_a_part_that_was_whole_already_is_put_in_place(client, run_id, archive, tmp_path):
    name = hashlib.sha256(archive).hexdigest()
    (tmp_path / f".run.h5.{name}.part").write_bytes(archive)
    assert client.run(str(run_id)).pull(tmp_path / "run.h5").read_bytes() == archive


def test_a_damaged_part_is_not_kept(client, run_id, archive, tmp_path):
    name = hashlib.sha256(archive).hexdigest()
    (tmp_path / f".run.h5.{name}.part").write_bytes(b"x" * 100)
    with pytest.raises(ServerError, match="damaged on its way"):
        client.run(str(run_id)).pull(tmp_path / "run.h5")
    assert not (tmp_path / "run.h5").exists()
    assert client.run(str(run_id)).pull(tmp_path / "run.h5").read_bytes() == archive


def test_a_file_comes_through_a_proxy_that_does_not_say_how_long_it_is(hasty, tmp_path):
    name = hashlib.sha256(b"whole").hexdigest()

    def chunked(request: httpx.Request) -> httpx.Response:
        return httpx.Response(200, headers={"etag": f'"{name}"'}, content=iter([b"wh", b"ole"]))

    client, told = Client("http://box", transport=httpx.MockTransport(chunked)), []
    files.fetch(client.connection, "x", tmp_path / "x", lambda *so_far: told.append(so_far))
    assert (tmp_path / "x").read_bytes() == b"whole"
    assert told == [(0, 0), (5, 5)]


def test_a_full_disk_is_told_with_the_file(hasty, tmp_path, monkeypatch):
    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    name = hashlib.sha256(b"whole").hexdigest()
    answer = httpx.Response(200, headers={"etag": f'"{name}"'}, content=iter([b"whole"]))
    client = Client("http://box", transport=httpx.MockTransport(lambda _: answer))
    with pytest.raises(OSError, match=rf"No space left on device: '.*\.x\.{name}\.part'"):
        files.fetch(client.connection, "x", tmp_path / "x")
