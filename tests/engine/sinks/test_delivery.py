"""A sink that hangs, fails or is full changes nothing about a run, and is named once."""

import logging
import sys
import time

import pytest
from few_reports import report_of
from small_spec import SMALL_RUN

from microcosmos import spec
from microcosmos.build.local import evolve
from microcosmos.sinks import delivery
from microcosmos.sinks.address import parse, parse_all
from microcosmos.sinks.record import Record, of_file

SPEC = spec.parse(SMALL_RUN)
RECORD = Record("run-1", "A run", {"seed": 3})
ADDRESS = parse("tensorboard:runs")

PROCESS = """
import os, signal, sys, time
signal.alarm(100)  # As `process.main` does at the end of its run.
from microcosmos.sinks import messages, process

class Broken:
    def __init__(self, opening):
        self.fault = opening.header["target"]
        if self.fault == "dies":
            os._exit(1)

    def _fail(self, *given):
        if self.fault == "hangs":
            time.sleep(600)
        if self.fault == "is full":
            raise OSError(28, "No space left on device")
        raise RuntimeError("no such project")

    reports = picture = file = close = _fail

process.open_sink = Broken
process.main(lambda data: None)
"""
HANGS = "import signal, time; signal.alarm(100); time.sleep(600)"
REASONS = {
    "hangs": "does not answer",
    "raises": "no such project",
    "is full": "No space left",
    "dies": "does not answer",
}


@pytest.fixture
def instead(monkeypatch):
    """Let other code run in the process of every sink, and do not wait for long."""

    def run(code, patience=0.5):
        monkeypatch.setattr(delivery, "COMMAND", (sys.executable, "-c", code))
        monkeypatch.setattr(delivery, "PATIENCE", patience)

    return run


@pytest.mark.long
def test_the_archive_has_the_same_bytes_whatever_sinks_do(plain, instead, tmp_path, caplog):
    instead(PROCESS, patience=10.0)
    path = tmp_path / "run.h5"
    with caplog.at_level(logging.WARNING):
        assert evolve(SPEC, path, sinks=[f"tensorboard:{fault}" for fault in REASONS])
    assert path.read_bytes() == plain.read_bytes()
    warned = [one.getMessage() for one in caplog.records if "Sink" in one.getMessage()]
    assert len(warned) == len(REASONS)
    for (fault, reason), warning in zip(REASONS.items(), warned, strict=True):
        assert f"Sink tensorboard:{fault}: 6 of 6 messages are not delivered" in warning
        assert reason in warning


def test_a_program_that_cannot_start_is_no_failure(monkeypatch, caplog):
    monkeypatch.setattr(delivery, "COMMAND", ("/nonexistent/python",))
    with delivery.Sinks([ADDRESS], RECORD) as sinks:
        sinks.report(report_of(1))
    assert "1 of 1 messages are not delivered" in caplog.text
    assert "No such file" in caplog.text


def test_a_missing_library_is_named(instead, caplog):
    blocked = "import sys; sys.modules['tensorboardX'] = None\n"
    instead(
        blocked + "from microcosmos.sinks.process import main; main(lambda data: None)", 20.0
    )
    with delivery.Sinks([ADDRESS], RECORD) as sinks:
        sinks.report(report_of(1))
        sinks.close(1, {}, done=True)
    assert 'pip install "microcosmos[tensorboard]"' in caplog.text


def test_a_full_queue_drops_and_never_waits(instead, monkeypatch, caplog):
    monkeypatch.setattr(delivery, "LENGTH", 10)
    instead(HANGS)
    with delivery.Sinks([ADDRESS], RECORD) as sinks:
        for step in range(20_000):
            sinks.report(report_of(step))
        for step in range(5):
            sinks.checkpoint(step, bytes(1 << 20))
        sinks.close(1, {"run.h5": bytes(1 << 20)}, done=False)
    assert "20,001 of 20,001 messages are not delivered" in caplog.text


def wait_until_taken(feed):
    end = time.monotonic() + 60
    while feed._queue.qsize():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_pictures_go_on_after_one_found_a_full_queue(tmp_path, instead, monkeypatch):
    """The process reads nothing until a file is there, so that the queue stays full."""
    gate, seen = tmp_path / "gate", tmp_path / "seen"
    monkeypatch.setattr(delivery, "LENGTH", 2)
    instead(SLOW.format(gate=str(gate), seen=str(seen)), patience=60.0)
    feed = delivery.Feed(ADDRESS, RECORD)
    large = delivery.Message({"kind": "report", "step": 0, "values": {}}, bytes(1 << 22))
    feed.offer(large)  # The pipe is full: the thread waits in the middle of it.
    wait_until_taken(feed)
    for step in (1, 2):
        feed.offer(delivery.Message({"kind": "report", "step": step, "values": {}}))
    feed.offer(delivery.Message({"kind": "archive", "step": 3}, b"dropped"))
    gate.touch()
    wait_until_taken(feed)
    feed.offer(delivery.Message({"kind": "archive", "step": 4}, b"delivered"))
    feed.end(delivery.Message({"kind": "end", "done": True}))
    feed.close(time.monotonic() + 60)
    assert seen.read_text().split() == ["open", "report", "report", "report", "archive", "end"]


SLOW = """
import pathlib, signal, sys, time
from microcosmos.sinks.messages import receive
signal.alarm(100)
while not pathlib.Path({gate!r}).exists():
    time.sleep(0.01)
kinds = []
while message := receive(sys.stdin.buffer):
    kinds.append(message.kind)
pathlib.Path({seen!r}).write_text(" ".join(kinds))
"""


def test_pictures_keep_their_distance(instead, monkeypatch, caplog):
    monkeypatch.setattr(delivery, "PICTURE_SECONDS", 0.0)
    instead(HANGS)
    with delivery.Sinks([ADDRESS], RECORD) as sinks:
        sinks.checkpoint(1, b"archive")
        monkeypatch.setattr(delivery, "PICTURE_SECONDS", 600.0)
        sinks.checkpoint(2, b"archive")
        sinks.close(2, {}, done=True)
    assert "1 of 1 messages are not delivered" in caplog.text


def test_numbers_are_finite_and_grouped():
    report = report_of(3, best=float("nan"), summary={"neat: inserted": 4, "ended": "soon"})
    found = delivery.numbers(report)
    assert found["neat/inserted"] == 4
    assert "best" not in found
    assert "ended" not in found


@pytest.mark.parametrize("text", ["tensorboard", "tensorboard:", "csv:file", "runs"])
def test_other_addresses_are_refused(text):
    with pytest.raises(ValueError, match="a sink must be tensorboard:"):
        parse(text)


def test_passwords_do_not_stand_in_addresses():
    with pytest.raises(ValueError, match="MLFLOW_TRACKING_PASSWORD") as refused:
        parse("mlflow:https://me:secret@host/x")
    assert "secret" not in str(refused.value)


def test_addresses_count_once():
    texts = ["tensorboard:runs", " tensorboard:runs", "", "wandb:team/project"]
    assert [str(one) for one in parse_all(texts)] == ["tensorboard:runs", "wandb:team/project"]


def test_a_record_stays_that_of_its_path_and_spec(tmp_path):
    document = SPEC.model_dump(mode="json")
    longer = spec.parse(SMALL_RUN | {"search": {"generations": 9, "batch": 8}})
    other = spec.parse(SMALL_RUN | {"seed": 7})
    path = tmp_path / "a run.h5"
    first = of_file(path, document, 0)
    assert first.id == of_file(path, longer.model_dump(mode="json"), 4).id
    assert first.id != of_file(path, other.model_dump(mode="json"), 0).id
    assert first.id != of_file(tmp_path / "b" / "a run.h5", document, 0).id
    assert first.id.startswith("a-run-")
