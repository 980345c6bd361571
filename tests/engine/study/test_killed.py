"""A study that is killed goes on, and ends with the bytes of one that is not."""

import hashlib
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

from microcosmos.study import plan, read

pytestmark = pytest.mark.long

PATIENCE = 120
"""Seconds until a file must be there, or a process must end."""
LONG = {"search.generations": 25}
FIGURES = [{"kind": "curves", "of": "Viscosity"}]


@pytest.fixture
def start():
    """A function that starts `microcosmos study` in a process of its own."""
    processes = []

    def run(path, *options):
        command = [sys.executable, "-m", "microcosmos", "study", str(path)]
        command += ["--checkpoint-seconds", "0", *options]
        processes.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))
        return processes[-1]

    yield run
    for process in processes:
        process.kill()
        process.wait()
        process.stderr.close()


@pytest.fixture
def long_study(study_file, planned):
    sweep = planned().study.sweeps["viscosity"].model_dump() | {"set": LONG}
    return lambda: study_file(sweeps={"viscosity": sweep}, figures=FIGURES)


def wait_for(true, process):
    end = time.monotonic() + PATIENCE
    while not true():
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < end
        time.sleep(0.02)


def finish(process):
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, said


def hashes(folder):
    """Return the SHA-256 of each file by its path, without the measured speed."""
    found = {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")}
    return {
        str(path): hashlib.sha256(data).hexdigest()
        for path, data in found.items()
        if path.name != "speed.json"
    }


def test_a_study_killed_twice_ends_with_the_same_bytes(start, long_study):
    whole, broken = long_study(), long_study()
    finish(start(whole))
    found = plan(read(broken), broken.with_suffix(".study"), broken.parent)
    first, second = found.unique()
    process = start(broken)
    wait_for(lambda: 3 < first.done()[0] < 25, process)
    process.kill()
    process.wait()
    assert first.done()[0] < 25

    process = start(broken, "--processes", "2")
    wait_for(lambda: second.done()[0] > 3, process)
    workers = psutil.Process(process.pid).children()
    assert len(workers) == 2
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    _, alive = psutil.wait_procs(workers, PATIENCE)
    assert not alive, "a worker ends when its study does"
    assert not all(run.done()[1] for run in found.unique())
    assert not (found.folder / "report.html").exists()

    finish(start(broken))
    assert hashes(found.folder) == hashes(whole.with_suffix(".study"))


def test_a_stopped_study_says_how_to_go_on(start, long_study):
    path = long_study()
    found = plan(read(path), path.with_suffix(".study"), path.parent)
    process = start(path)
    wait_for(lambda: found.unique()[0].done()[0] > 0, process)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130
    assert "The same command goes on from" in said
