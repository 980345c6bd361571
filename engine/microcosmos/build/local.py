"""Run a spec without a server: evolve it into an archive file and resume it."""

import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any

from ..archive.atomic import write_whole
from ..archive.beside import beside
from ..experiments import Experiment, Report, Stopped, breeding
from ..experiments.evolution import Evolution
from ..search import never
from ..sinks import address
from ..sinks.delivery import Sinks
from ..sinks.record import of_file
from ..spec import Archive, Refinement, Spec, breeding_refusal
from . import build

Choices = Mapping[int, Sequence[Mapping[str, Any]]]
"""Files of chosen creatures, by the generation from which they count."""


def evolve(
    spec: Spec,
    archive: Path,
    *,
    stop: Callable[[], bool] = never,
    tell: Callable[[Report], None] = lambda report: None,
    sinks: Sequence[str] = (),
    checkpoint_seconds: float = 60.0,
    other_device: bool = False,
    initial: Sequence[Mapping[str, Any]] = (),
    choices: Choices | None = None,
    over: Callable[[Experiment], AbstractContextManager[Experiment]] = nullcontext,
) -> bool:
    """Continue a run until it is done or `stop()` is true; return whether it is done.

    The archive file is the checkpoint: a run resumed from it ends with the same bytes as an
    uninterrupted one. The best creature is written beside it. `initial` are the creature files
    that `search.initial` names; a resumed run needs none. `over` may give the run other
    devices, as `partial(cluster.over, url="tls://host:8786")` does. `sinks` are places that get
    curves, pictures and the last files, as `tensorboard:FOLDER`; they never fail or slow the
    run, see `docs/exports.md`. Raises `ValueError` where
    the file is of another spec or of other `choices`, where a choice is of no creature of the
    run, and, without `other_device`, where the file is of another kind of device.
    """
    addresses = address.parse_all(sinks)
    if choices and (refusal := breeding_refusal(spec.model_dump(mode="json"))):
        raise ValueError(refusal)
    built = build(spec, initial) if initial else build(spec)
    with over(built) as experiment:
        state = _begun(experiment, archive, other_device)
        if choices:
            _refuse_others(experiment, state, choices)
        document = spec.model_dump(mode="json")
        record = of_file(archive, document, getattr(state, "generation", 0))
        with Sinks(addresses, record) as followers:
            given = experiment, state, archive, stop, tell, followers, checkpoint_seconds
            return _carry_out(*given, choices or {})


def _begun(experiment: Experiment, archive: Path, other_device: bool) -> Any:
    if archive.exists():
        return experiment.restore(archive.read_bytes(), other_device=other_device)
    return experiment.init()


def _refuse_others(experiment: Experiment, state: Any, choices: Choices) -> None:
    """Raise `ValueError` unless the state was computed with the choices up to it."""
    assert isinstance(experiment, Evolution)  # `breeding_refusal` refuses others.
    given = {
        (generation, file["sha256"])
        for generation, files in choices.items()
        if generation <= state.generation
        for file in files
    }
    known = set(breeding.rows(state.choices))
    if given != known:
        generation, name = min(given ^ known)
        raise ValueError(
            f"`choices` must be those of the archive up to its generation {state.generation}; "
            f"they differ in creature {name[:12]} of generation {generation}"
        )


def _carry_out(
    experiment: Experiment,
    state: Any,
    archive: Path,
    stop: Callable[[], bool],
    tell: Callable[[Report], None],
    sinks: Sinks,
    checkpoint_seconds: float,
    choices: Choices,
) -> bool:
    saved = time.monotonic()
    try:
        while not experiment.done(state):
            files = choices.get(state.generation + 1)
            before: Any = state
            if files and isinstance(experiment, Evolution):
                before = experiment.choose(state, files)
            state, report = experiment.advance(before, stop)
            tell(report)
            sinks.report(report)
            if time.monotonic() - saved >= checkpoint_seconds:
                sinks.checkpoint(state.generation, _save(experiment, state, archive))
                saved = time.monotonic()
    except Stopped:
        pass
    data, done = _save(experiment, state, archive), experiment.done(state)
    files = {archive.name: data} if done else {}
    if done and (best := beside(archive, ".best.json")).exists():
        files[best.name] = best.read_bytes()
    sinks.close(state.generation, files, done=done)
    return done


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


def _save(experiment: Experiment, state: Any, archive: Path) -> bytes:
    """Write the archive file, and the best creature beside it; return the former."""
    data = experiment.save(state)
    write_whole(archive, data)
    best = experiment.best(state)
    if best is not None:
        path = beside(archive, ".best.json")
        write_whole(path, json.dumps(best, indent=1).encode())
    return data
