"""The sink MLflow: a run of a tracking server, a database or a folder."""

import os
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

from ..optional import require
from ..version import VERSION
from .address import Record, Refused
from .process import Report

EXTRA = "microcosmos[mlflow]"
EXPERIMENT = "microcosmos"
"""The experiment, unless MLFLOW_EXPERIMENT_NAME names another."""
TAG = "microcosmos.run"
"""The tag by which a resumed run finds its record."""
ATTEMPT = "microcosmos.attempt"
"""The tag of the newest attempt: the generation from which it goes on, and its own name."""
MARKER = "evaluations"
"""A metric of every report, whose steps are those that are recorded."""
METRICS, PARAMETERS = 1000, 100
"""MLflow's limits: metrics and parameters of a request."""
INVALID = "INVALID_PARAMETER_VALUE"
"""The code of MLflow's errors about a value."""
UNNAMED = re.compile(r"[^\w.\- /]", re.ASCII)
"""Characters that MLflow refuses in a name, such as the + of `iso+line`."""


class MLflow:
    """One run of MLflow; steps that it has already are not written again.

    MLflow would keep both points. The steps after the last checkpoint that a crashed attempt
    has recorded stay as they are: the run computes the same numbers again. The process of an
    earlier attempt may live on: it leaves the steps, files and status of the newest one alone.
    """

    def __init__(self, target: str, record: Record):
        library, self._entities = require("mlflow", EXTRA), require("mlflow.entities", EXTRA)
        self._error = require("mlflow.exceptions", EXTRA).MlflowException
        self._longest = require("mlflow.utils.validation", EXTRA).MAX_PARAM_VAL_LENGTH
        self._refused: dict[str, str] = {}
        self._names: dict[str, str] = {}
        self._client = library.MlflowClient(target)
        name = os.environ.get("MLFLOW_EXPERIMENT_NAME", EXPERIMENT)
        known = self._client.get_experiment_by_name(name)
        place = known.experiment_id if known else self._client.create_experiment(name)
        filtered = f"tags.`{TAG}` = '{record.id}'"
        earlier = self._client.search_runs([place], filter_string=filtered, max_results=1)
        self._attempt = f"{record.generation} {uuid4().hex}"
        if earlier:
            self._run = earlier[0].info.run_id
            self._client.set_tag(self._run, ATTEMPT, self._attempt)
            self._client.update_run(self._run, status="RUNNING")
            self._tag_changes(record.spec, earlier[0].data.params)
        else:
            tags = {TAG: record.id, ATTEMPT: self._attempt, "microcosmos.version": VERSION}
            made = self._client.create_run(place, tags=tags, run_name=record.name)
            self._run = made.info.run_id
            params = self._parameters(record.spec)
            self._write("params", [self._entities.Param(*one) for one in params], PARAMETERS)
        self._known: set[int] | None = None

    def _parameters(self, spec: Mapping[str, Any]) -> list[tuple[str, str]]:
        """Return the fields of a spec as MLflow takes them; note what is not written whole."""
        found: list[tuple[str, str]] = []
        for name, text in flat(spec):
            if (key := self._own(name, "parameter")) is None:
                continue
            if len(text) > self._longest:
                self._refused[name] = f"all but the first {self._longest:,} characters"
            found.append((key, text[: self._longest]))
        return found

    def _tag_changes(self, spec: Mapping[str, Any], before: Mapping[str, str]) -> None:
        """Write tags for fields that have changed, as generations do: parameters never do."""
        for key, text in self._parameters(spec):
            if before.get(key, text) != text:
                self._client.set_tag(self._run, key, text)

    def _own(self, name: str, kind: str) -> str | None:
        """Return a name as MLflow takes it; None, with a note, if another one is so called."""
        key = taken(name)
        owner = self._names.setdefault(f"{kind} {key}", name)
        if owner == name:
            return key
        self._refused[name] = f"its {kind} {key} is that of {owner}"
        return None

    def _followed_from(self) -> int | None:
        """Return the generation from which a newer attempt goes on; None if there is none."""
        newest = self._client.get_run(self._run).data.tags[ATTEMPT]
        return None if newest == self._attempt else int(newest.split()[0])

    def _write(self, kind: str, entities: Sequence[Any], size: int) -> None:
        """Write metrics or parameters; note those that MLflow refuses."""
        for first in range(0, len(entities), size):
            together = entities[first : first + size]
            try:
                self._client.log_batch(self._run, **{kind: together})
            except self._error as error:
                if error.error_code != INVALID:
                    raise
                if size > 1:  # One wrong name loses its whole request.
                    self._write(kind, together, 1)
                else:
                    self._refused[together[0].key] = str(error)

    def reports(self, reports: Sequence[Report]) -> None:
        now, metric = int(time.time() * 1000), self._entities.Metric
        end = self._followed_from()
        if self._known is None or end is not None:  # Another attempt may be writing.
            history = self._client.get_metric_history(self._run, MARKER)
            self._known = {one.step for one in history}
        new = [
            (step, values)
            for step, values in reports
            if step not in self._known and (end is None or step <= end)
        ]
        self._known |= {step for step, _ in new}
        pending: list[Any] = []
        for step, values in new:
            # A report is written whole: its `MARKER` says that all of it is there.
            if len(pending) + len(values) > METRICS:
                self._write("metrics", pending, METRICS)
                pending = []
            pending += [
                metric(key, value, now, step)
                for name, value in values.items()
                if (key := self._own(name, "metric")) is not None
            ]
        self._write("metrics", pending, METRICS)
        if self._refused:
            raise Refused(self._refused)

    def picture(self, step: int, png: bytes) -> None:
        self._log(f"archive-{step:06}.png", png, "pictures")

    def file(self, name: str, data: bytes) -> None:
        self._log(name, data, None)

    def _log(self, name: str, data: bytes, folder: str | None) -> None:
        if self._followed_from() is not None:
            return
        with TemporaryDirectory() as beside:
            path = Path(beside, name)
            path.write_bytes(data)
            self._client.log_artifact(self._run, str(path), folder)

    def close(self, done: bool) -> None:
        if self._followed_from() is None:
            self._client.set_terminated(self._run, "FINISHED" if done else "KILLED")


def taken(name: str) -> str:
    """Return a name with an underscore for what MLflow refuses in one."""
    return UNNAMED.sub("_", name)


def flat(document: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str]]:
    """Yield the fields of a spec by their dotted paths, lists as one text."""
    for name, value in document.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{path}{name}.")
        else:
            yield f"{path}{name}", str(value)
