"""A run without a server: evolve a spec into an archive file, and take it up again."""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .archive.store import write_whole
from .build import build
from .experiments import Experiment, Report, Stopped
from .search import never
from .spec import Spec


def evolve(
    spec: Spec,
    archive: Path,
    *,
    stop: Callable[[], bool] = never,
    tell: Callable[[Report], None] = lambda report: None,
    checkpoint_seconds: float = 60.0,
    other_device: bool = False,
) -> bool:
    """Carry a run on until it is done or `stop()` says so; whether it is done.

    The archive file is the checkpoint: where it exists, the run goes on from it and ends
    with the same bytes as without the interruption. The best creature is written beside
    it. Raises `ValueError` where the file is of another spec or, without `other_device`,
    of another kind of device.
    """
    experiment = build(spec)
    state = experiment.init()
    if archive.exists():
        state = experiment.restore(archive.read_bytes(), other_device=other_device)
    saved = time.monotonic()
    try:
        while not experiment.done(state):
            state, report = experiment.advance(state, stop)
            tell(report)
            if time.monotonic() - saved >= checkpoint_seconds:
                keep(experiment, state, archive)
                saved = time.monotonic()
    except Stopped:
        pass
    keep(experiment, state, archive)
    return experiment.done(state)


def keep(experiment: Experiment, state: Any, archive: Path) -> None:
    """Write the archive file and, beside it, the creature file of its best elite."""
    write_whole(archive, experiment.save(state))
    best = experiment.best(state)
    if best is not None:
        path = archive.with_suffix(".best.json")
        write_whole(path, json.dumps(best, indent=1).encode())
