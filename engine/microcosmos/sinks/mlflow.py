"""The sink MLflow: a run of a tracking server, a database or a folder."""

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ..optional import require
from ..version import VERSION
from .process import Report
from .record import Record

EXTRA = "microcosmos[mlflow]"
EXPERIMENT = "microcosmos"
"""The experiment, unless MLFLOW_EXPERIMENT_NAME names another."""
TAG = "microcosmos.run"
"""The tag by which a resumed run finds its record."""
MARKER = "evaluations"
"""A metric of every report, whose last step is the last one that is recorded."""
METRICS, PARAMETERS, LONGEST = 1000, 100, 500
"""What MLflow takes in one request, and the longest value of a parameter."""


class MLflow:
    """One run of MLflow; steps that it has already are not written again.

    MLflow would keep both points. The steps after the last checkpoint that a crashed attempt
    has recorded stay as they are: the run computes the same numbers again.
    """

    def __init__(self, target: str, record: Record):
        library, self._entities = require("mlflow", EXTRA), require("mlflow.entities", EXTRA)
        self._client = library.MlflowClient(target)
        name = os.environ.get("MLFLOW_EXPERIMENT_NAME", EXPERIMENT)
        found = self._client.get_experiment_by_name(name)
        place = found.experiment_id if found else self._client.create_experiment(name)
        filtered = f"tags.`{TAG}` = '{record.id}'"
        known = self._client.search_runs([place], filter_string=filtered, max_results=1)
        if known:
            self._run = known[0].info.run_id
            self._client.update_run(self._run, status="RUNNING")
        else:
            tags = {TAG: record.id, "microcosmos.version": VERSION}
            made = self._client.create_run(place, tags=tags, run_name=record.name)
            self._run = made.info.run_id
            self._write_parameters(record.spec)
        history = self._client.get_metric_history(self._run, MARKER)
        self._last = max((one.step for one in history), default=-1)

    def _write_parameters(self, spec: Mapping[str, Any]) -> None:
        param = self._entities.Param
        found = [param(name, text[:LONGEST]) for name, text in flat(spec)]
        for first in range(0, len(found), PARAMETERS):
            self._client.log_batch(self._run, params=found[first : first + PARAMETERS])

    def reports(self, reports: Sequence[Report]) -> None:
        now, metric = int(time.time() * 1000), self._entities.Metric
        pending: list[Any] = []
        for step, values in reports:
            if step <= self._last:
                continue
            if len(pending) + len(values) > METRICS:
                self._client.log_batch(self._run, metrics=pending)
                pending = []
            pending += [metric(name, value, now, step) for name, value in values.items()]
        if pending:
            self._client.log_batch(self._run, metrics=pending)
        self._last = max([self._last, *(step for step, _ in reports)])

    def picture(self, step: int, png: bytes) -> None:
        self._log(f"archive-{step:06}.png", png, "pictures")

    def file(self, name: str, data: bytes) -> None:
        self._log(name, data, None)

    def _log(self, name: str, data: bytes, folder: str | None) -> None:
        with TemporaryDirectory() as beside:
            path = Path(beside, name)
            path.write_bytes(data)
            self._client.log_artifact(self._run, str(path), folder)

    def close(self, done: bool) -> None:
        self._client.set_terminated(self._run, "FINISHED" if done else "KILLED")


def flat(document: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """Yield the fields of a spec by their dotted paths, lists as one text."""
    for name, value in document.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", str(value)
