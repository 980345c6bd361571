"""The process tree of `make run`."""

import itertools
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from server.core.processes import spawn
from server.local.process_tree import Child, Tree

PARENT = """
import os, pathlib, subprocess, sys, time
from server.core.processes import spawn
child = spawn(["sleep", "60"], os.environ, pathlib.Path(sys.argv[1]))
print(child.pid, flush=True)
time.sleep(60)
"""


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
    """What starts a process that sleeps, and counts how often it was asked to."""
    started = []

    def start():
        started.append(spawn(["sleep", "60"], os.environ, tmp_path / "log"))
        return started[-1]

    start.started = started
    yield start
    for process in started:
        process.kill()
        process.wait()


def test_a_child_ends_with_a_parent_that_was_killed(tmp_path):
    command = [sys.executable, "-c", PARENT, str(tmp_path / "log")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout
        child = psutil.Process(int(parent.stdout.readline()))
        parent.kill()
    child.wait(timeout=5)


def test_a_child_that_died_is_started_again_and_said(sleeper, monkeypatch, capsys):
    monkeypatch.setattr("server.local.process_tree.BACKOFF", 0.01)
    tree = Tree()
    tree.children.append(Child("worker", sleeper))
    sleeper.started[0].kill()
    tree.watch(enough=lambda: len(sleeper.started) > 1)
    assert "worker     died (signal SIGKILL)" in capsys.readouterr().out
    assert sleeper.started[1].poll() is None


def test_a_child_that_keeps_dying_is_started_ever_more_slowly(tmp_path, monkeypatch):
    monkeypatch.setattr("server.local.process_tree.BACKOFF", 0.05)
    starts = []

    def start():
        starts.append(time.monotonic())
        return spawn(["false"], os.environ, tmp_path / "log")

    tree = Tree()
    tree.children.append(Child("server", start))
    tree.watch(enough=lambda: len(starts) > 3)
    tree.children[0].process.wait()
    waits = [b - a for a, b in itertools.pairwise(starts)]
    assert all(wait > 0.05 * 2**n for n, wait in enumerate(waits)), waits


def test_a_terminals_interrupt_does_not_reach_the_children_before_us(sleeper):
    process = sleeper()
    assert os.getpgid(process.pid) == process.pid != os.getpgid(0)


def test_what_others_stand_on_ends_last(tmp_path):
    order = tmp_path / "order"

    def start(name):
        command = [sys.executable, "-c", SAY_WHEN_ASKED_TO_END, str(order), name]
        return lambda: spawn(command, os.environ, tmp_path / name)

    tree = Tree()
    tree.services.append(Child("redis", start("ground")))
    tree.children.append(Child("server", start("child ")))
    for name in ("ground", "child "):
        wait_until(lambda name=name: "up" in (tmp_path / name).read_text())
    tree.end()
    assert order.read_text() == "child ground"


def test_what_ignores_the_end_is_killed_after_its_grace(tmp_path, monkeypatch):
    monkeypatch.setattr("server.local.process_tree.GRACE", 0.1)
    command = [sys.executable, "-c", IGNORE_THE_END]
    tree = Tree()
    child = Child("worker", lambda: spawn(command, os.environ, tmp_path / "log"))
    tree.children.append(child)
    wait_until(lambda: "up" in (tmp_path / "log").read_text())
    tree.end()
    assert child.process.wait(timeout=5) == -signal.SIGKILL
