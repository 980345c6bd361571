"""A name that MLflow refuses loses one value, and the sink says so."""

import logging
import sys
from pathlib import Path

import mlflow
import pytest
from few_reports import report_of

from microcosmos.sinks import delivery
from microcosmos.sinks.address import Record, Refused, parse
from microcosmos.sinks.mlflow import MLflow

pytestmark = pytest.mark.filterwarnings("ignore")
RECORD = Record("run-1", "A run", {"seed": 3})
SPEC = {"world": {"width": 24}, "settings": {"speed (µm/s)": 3, "a//b": 4}}


@pytest.fixture(scope="module")
def target(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mlflow")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)  # Artifacts lie beside the process.
        yield f"sqlite:///{folder / 'mlflow.db'}"


def recorded(target, name):
    """The client, a run, and a function that returns the points of a metric."""
    client = mlflow.MlflowClient(target)
    place = client.get_experiment_by_name("microcosmos")
    (run,) = client.search_runs([place.experiment_id], f"attributes.run_name = '{name}'")

    def points(name):
        history = client.get_metric_history(run.info.run_id, name)
        return sorted((one.step, one.value) for one in history)

    return client, run, points


def test_names_and_texts_are_written_as_mlflow_takes_them_and_the_rest_is_named(target):
    spec = SPEC | {"a+b": 1, "a_b": 2, "long": "x" * 7000}
    sink = MLflow(target, Record("run-1", "Names", spec))
    values = {"evaluations": 8.0, "emitter/iso+line/inserted": 3.0, "a//b": 1.0, "best": 0.5}
    values["emitter/iso_line/inserted"] = 4.0
    with pytest.raises(Refused) as refused:
        sink.reports([(1, values), (2, values)])
    assert refused.value.reasons.keys() == {
        *("settings.a//b", "a//b", "a_b", "long", "emitter/iso_line/inserted")
    }
    assert refused.value.reasons["long"] == "all but the first 6,000 characters"
    _, run, points = recorded(target, "Names")
    assert run.data.params["settings.speed __m/s_"] == "3"
    assert run.data.params["world.width"] == "24"
    assert run.data.params["a_b"] == "1"
    assert run.data.params["long"] == "x" * 6000
    for name, value in (("emitter/iso_line/inserted", 3.0), ("best", 0.5)):
        assert points(name) == [(1, value), (2, value)]


def test_a_process_that_lives_on_leaves_the_newest_attempt_alone(target):
    def reports(first, last, offset):
        return [(step, {"evaluations": step + offset}) for step in range(first, last + 1)]

    old, newer, newest = (
        MLflow(target, Record("run-2", "Attempts", {"search": {"generations": length}}, start))
        for start, length in ((0, 6), (4, 6), (5, 9))
    )
    newest.reports(reports(6, 7, 0.5))
    newer.reports(reports(5, 8, 0.25))
    old.reports(reports(1, 6, 0.0))
    newest.reports(reports(8, 9, 0.5))
    newest.file("best.json", b"new")
    newest.close(True)
    old.file("best.json", b"old")
    old.close(False)
    client, run, points = recorded(target, "Attempts")
    assert points("evaluations") == [
        *((step, step) for step in range(1, 5)),
        *((5, 5.25), (6, 6.5), (7, 7.5), (8, 8.5), (9, 9.5)),
    ]
    assert run.info.status == "FINISHED"
    assert run.data.params["search.generations"] == "6"  # MLflow changes no parameter.
    assert run.data.tags["search.generations"] == "9"
    back = client.download_artifacts(run.info.run_id, "best.json")
    assert Path(back).read_bytes() == b"new"


PROCESS = """
from microcosmos.sinks import process
from microcosmos.sinks.address import Refused

class Choosy:
    def reports(self, reports):
        raise Refused({"a//b": "is no name"})

    def close(self, done):
        pass

process.open_sink = lambda opening: Choosy()
process.main(lambda data: None)
"""


def test_what_a_sink_refuses_is_named_once_and_all_else_counts_as_delivered(
    monkeypatch, caplog
):
    monkeypatch.setattr(delivery, "COMMAND", (sys.executable, "-c", PROCESS))
    with caplog.at_level(logging.WARNING), delivery.Sinks([parse("mlflow:x")], RECORD) as sinks:
        for generation in (1, 2):
            sinks.report(report_of(generation))
    (warned,) = (one.getMessage() for one in caplog.records)
    assert warned == "Sink mlflow:x refuses a//b (is no name); it has all other values."
