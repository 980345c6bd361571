"""A sink that hangs, fails or is full changes nothing about a run, and is named once."""

import io
import json
import logging
import sys
import time
from unittest.mock import Mock, call

import pytest
from few_reports import report_of
from small_spec import SMALL_RUN

from microcosmos import spec
from microcosmos.archive.file import HDF5
from microcosmos.build.local import evolve
from microcosmos.sinks import delivery, process
from microcosmos.sinks.address import Message, Record, of_file, parse, parse_all

SPEC = spec.parse(SMALL_RUN)
RECORD = Record("run-1", "A run", {"seed": 3})
ADDRESS = parse("tensorboard:runs")

PROCESS = """
import os, signal, sys, time
signal.alarm(100)  # As `process.main` does at the end of its run.
from microcosmos.sinks import process

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
LATE = """
import pathlib, time
from microcosmos.sinks import process
process.LINGER = 1

class Late:
    def reports(self, reports):
        pathlib.Path({begun!r}).touch()
        time.sleep(100)

    def close(self, done):
        pathlib.Path({ended!r}).write_text(str(done))

process.open_sink = lambda opening: Late()
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


def test_no_curve_has_the_name_of_a_group():
    summary = {"infeasible.non-finite": 2, "loss": 0.5, "loss.ring": 0.25}
    summary |= {"emitter.iso.children": 8, "slopes.length": 3.0, "length": 0.2}
    found = delivery.numbers(report_of(1, summary=summary))
    assert found == {
        "evaluations": 8,
        "infeasible": 0,
        "infeasible_by/non-finite": 2,
        "qd_score": 1.5,
        "loss": 0.5,
        "loss_by/ring": 0.25,
        "length": 0.2,
        "slopes/length": 3.0,
        "emitter/iso/children": 8,
    }
    assert not [name for name in found for other in found if other.startswith(f"{name}/")]


@pytest.mark.parametrize(("data", "pictures"), [(HDF5 + b"...", 1), (b"{}", 0)])
@pytest.mark.parametrize("name", ["run", "run.hdf5", "run.h5", "best.json"])
def test_the_archive_is_drawn_at_the_end_whatever_its_name(name, data, pictures):
    sink, answers = Mock(), io.StringIO()
    message = Message({"kind": "file", "name": name, "step": 4}, data)
    process.Deliveries(sink, answers, lambda archive: b"PNG").take([message])
    assert sink.picture.mock_calls == [call(4, b"PNG")] * pictures
    sink.file.assert_called_once_with(name, data)
    assert json.loads(answers.getvalue())["delivered"] == 1


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


@pytest.mark.parametrize("reports", [1, 1000])
def test_a_record_is_ended_where_the_time_for_its_backlog_runs_out(
    instead, monkeypatch, tmp_path, reports
):
    """Of many reports most wait in the pipe, so that the process has not read the end."""
    begun, ended = tmp_path / "begun", tmp_path / "ended"
    instead(LATE.format(begun=str(begun), ended=str(ended)), patience=0.0)
    if reports > process.WAITING:
        monkeypatch.setattr(delivery, "LINGER", 1)
        monkeypatch.setattr(delivery, "LAST", 0)
    with delivery.Sinks([ADDRESS], RECORD) as sinks:
        (feed,) = sinks._feeds
        for step in range(reports):
            sinks.report(report_of(step))
        until = time.monotonic() + 60
        while not begun.exists():
            assert time.monotonic() < until
            time.sleep(0.01)
        sinks.close(1, {}, done=True)
    assert feed._process.wait(60) == 0
    assert ended.read_text() == "True"


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
from microcosmos.sinks.address import receive
signal.alarm(100)
while not pathlib.Path({gate!r}).exists():
    time.sleep(0.01)
kinds = []
while message := receive(sys.stdin.buffer):
    kinds.append(message.kind)
pathlib.Path({seen!r}).write_text(" ".join(kinds))
"""


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
