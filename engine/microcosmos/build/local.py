"""Run a spec without a server: evolve it into an archive file and resume it."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from ..archive.atomic import write_whole
from ..experiments import Experiment, Report, Stopped
from ..search import never
from ..spec import Archive, Refinement, Spec
from . import build


def evolve(
    spec: Spec,
    archive: Path,
    *,
    stop: Callable[[], bool] = never,
    tell: Callable[[Report], None] = lambda report: None,
    checkpoint_seconds: float = 60.0,
    other_device: bool = False,
    initial: Sequence[Mapping[str, Any]] = (),
    over: Callable[[Experiment], AbstractContextManager[Experiment]] = nullcontext,
) -> bool:
    """Continue a run until it is done or `stop()` is true; return whether it is done.

    The archive file is the checkpoint: a run resumed from it ends with the same bytes as an
    uninterrupted one. The best creature is written beside it. `initial` are the creature files
    that `search.initial` names; a resumed run needs none. `over` may give the run other
    devices, as `partial(cluster.over, url="tls://host:8786")` does. Raises `ValueError` where
    the file is of another spec or, without `other_device`, of another kind of device.
    """
    built = build(spec, initial) if initial else build(spec)
    with over(built) as experiment:
        return _carry_out(experiment, archive, stop, tell, checkpoint_seconds, other_device)


def _carry_out(
    experiment: Experiment,
    archive: Path,
    stop: Callable[[], bool],
    tell: Callable[[Report], None],
    checkpoint_seconds: float,
    other_device: bool,
) -> bool:
    if archive.exists():
        state = experiment.restore(archive.read_bytes(), other_device=other_device)
    else:
        state = experiment.init()
    saved = time.monotonic()
    try:
        while not experiment.done(state):
            state, report = experiment.advance(state, stop)
            tell(report)
            if time.monotonic() - saved >= checkpoint_seconds:
                _save(experiment, state, archive)
                saved = time.monotonic()
    except Stopped:
        pass
    _save(experiment, state, archive)
    return experiment.done(state)


def refine(
    file: Mapping[str, Any], archive: Archive | None = None, **options: Any
) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Refine a creature by gradient steps within its cell; return it and each step.

    `options` are those of `spec.Refinement`. The new creature file has the old one as its
    parent. Raises `ValueError` for an invalid file.
    """
    chosen = Refinement(creature=dict(file), archive=archive or Archive(), **options)
    experiment = build(chosen)
    state = experiment.init()
    while not experiment.done(state):
        state, _ = experiment.advance(state)
    refined = experiment.best(state)
    assert refined is not None
    return refined, [dict(row.values) for row in state.table.rows]


def _save(experiment: Experiment, state: Any, archive: Path) -> None:
    write_whole(archive, experiment.save(state))
    best = experiment.best(state)
    if best is not None:
        path = archive.with_suffix(".best.json")
        write_whole(path, json.dumps(best, indent=1).encode())
