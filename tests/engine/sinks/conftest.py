"""A small run with all sinks, and attempts at a run that crashes."""

import os
import signal
import time

import pytest
from few_reports import report_of
from small_spec import SMALL_RUN

from microcosmos import spec
from microcosmos.build.local import evolve
from microcosmos.sinks import delivery
from microcosmos.sinks.address import Record, parse
from microcosmos.sinks.delivery import Sinks

SPEC = spec.parse(SMALL_RUN)


@pytest.fixture(scope="session")
def plain(tmp_path_factory):
    """The path of an archive file, computed without sinks."""
    path = tmp_path_factory.mktemp("plain") / "run.h5"
    evolve(SPEC, path)
    return path


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Busy machines may take longer than people wait."""
    monkeypatch.setattr(delivery, "PATIENCE", 100.0)


@pytest.fixture(scope="session")
def follow():
    """Return a function that carries out the same run with sinks, and their folder."""

    def run(folder, *targets):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(delivery, "PATIENCE", 100.0)
            patch.chdir(folder)  # MLflow keeps files of a database beside the process.
            offline(patch, folder)
            evolve(SPEC, folder / "run.h5", sinks=targets)
        return folder

    return run


@pytest.fixture(scope="session")
def followed(follow, tmp_path_factory):
    """The folder of a run with two sinks: `events` and `wandb`."""
    folder = tmp_path_factory.mktemp("followed")
    return follow(folder, "tensorboard:events", "wandb:swimmers")


def offline(patch, folder):
    patch.setenv("WANDB_MODE", "offline")
    for name in ("DIR", "DATA_DIR", "CACHE_DIR", "CONFIG_DIR"):
        patch.setenv(f"WANDB_{name}", str(folder))


@pytest.fixture
def wandb_folder(tmp_path, monkeypatch):
    offline(monkeypatch, tmp_path)
    return tmp_path


def attempt(address, start, stop, *, killed=False):
    """Report the steps after `start`; kill the processes of the sink once it has them all."""
    record = Record("run-1", "A run", {"seed": 3, "world": {"width": 24}}, start)
    with Sinks([parse(address)], record) as sinks:
        (feed,) = sinks._feeds
        for step in range(start + 1, stop + 1):
            sinks.report(report_of(step, qd_score=step + start / 8))
        if not killed:
            sinks.close(stop, {"best.json": b"{}"}, done=stop == 8)
            return
        until = time.monotonic() + 60
        while feed._delivered < stop - start:
            assert time.monotonic() < until
            time.sleep(0.01)
        os.killpg(feed._process.pid, signal.SIGKILL)


@pytest.fixture(name="attempt")
def attempt_fixture():
    return attempt


@pytest.fixture
def attempts():
    """Report to a sink twice: up to generation 6, and after a crash again from 5 to 8."""

    def report(address):
        attempt(address, 0, 6)
        attempt(address, 4, 8)

    return report
