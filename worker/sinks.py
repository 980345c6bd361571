"""Sinks of a worker's run: TensorBoard, MLflow, W&B."""

import json
from collections.abc import Callable
from typing import Any

from microcosmos.experiments import Experiment
from microcosmos.sinks.address import parse_all
from microcosmos.sinks.delivery import Sinks
from microcosmos.sinks.record import Record
from server.attempts.attempt import Attempt


def open_sinks(attempt: Attempt, generation: int) -> Sinks:
    """Return the sinks that the settings name; a resumed run continues its record there."""
    name = f"{attempt.spec['experiment']}-{attempt.run_id}"
    record = Record(name, name, attempt.spec, generation)
    return Sinks(parse_all(attempt.services.settings.sinks.split(",")), record)


def last_files(
    experiment: Experiment, state: Any, save: Callable[[], bytes]
) -> dict[str, bytes]:
    """Return the files of a run that is done, by name."""
    files, best = {"run.h5": save()}, experiment.best(state)
    if best is not None:
        files["best.json"] = json.dumps(best, indent=1).encode()
    return files
