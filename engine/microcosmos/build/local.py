"""Run a spec without a server: evolve it into an archive file and resume it."""

import fcntl
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any

from ..archive import creature, export
from ..archive.atomic import place, write_whole
from ..archive.file_names import beside
from ..experiments import Experiment, Report, Stopped
from ..experiments.evolution import Evolution
from ..invalid import InvalidField
from ..search import never
from ..search.parts import breeding
from ..sinks import address
from ..sinks.address import of_file
from ..sinks.delivery import Sinks
from ..spec import Archive, Refinement, Spec, breeding_refusal
from . import build
from .parts import terms_of

Choices = Mapping[int, Sequence[Mapping[str, Any]]]
"""Files of chosen creatures, by the generation from which they count."""

BEST = ".best.json"
"""The end of the name of the best creature's file."""
PAUSE_PER_SAVE = 50
"""Least time between two checkpoints, in durations of the last one. Each writes the whole file,
which grows with the lineage; so saving takes at most 2 % of the time of any run."""


def evolve(
    spec: Spec,
    archive: str | Path,
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
    uninterrupted one. It is written every `checkpoint_seconds`, less often once writing takes
    2 % of the time; 0 is after every generation. The best creature is written beside it. Both
    keep the licence and credit of the file that a run goes on from, or of its initial
    creatures.
    `initial` are the creature files that `search.initial` names; a resumed run needs none.
    `over` may give the run other devices, as `partial(cluster.over, url="tls://host:8786")`
    does. `sinks` are places that get curves, pictures and the last files, as
    `tensorboard:FOLDER`; they never fail or slow the run, see `docs/exports.md`.

    Raises `ValueError` where the file is of another spec or of other `choices`, where a choice
    is of no creature of the run or no creature file, where another archive has the same name
    up to its ending, while another process writes the file, and, without `other_device`, where
    the file is of another kind of device.
    """
    archive, addresses = Path(archive), address.parse_all(sinks)
    if not checkpoint_seconds >= 0:  # A comparison with NaN is false.
        needed = f"must be a number of at least 0; got {checkpoint_seconds}"
        raise InvalidField("checkpoint_seconds", needed)
    if choices and (refusal := breeding_refusal(spec.model_dump(mode="json"))):
        raise refusal
    chosen = (choices or {}).items()
    choices = {number: [creature.parse(one) for one in files] for number, files in chosen}
    with _alone(archive):
        _refuse_twin(archive)
        built = build(spec, initial) if initial else build(spec)
        with over(built) as experiment:
            state = _begun(experiment, archive, other_device)
            data = archive.read_bytes() if archive.exists() else None
            terms = terms_of(spec, initial, data)
            if choices:
                _refuse_others(experiment, state, choices)
            document = spec.model_dump(mode="json")
            record = of_file(archive, document, getattr(state, "generation", 0))
            with Sinks(addresses, record) as followers:
                save = partial(_save, experiment, archive, terms)
                given = experiment, state, archive, stop, tell, followers, checkpoint_seconds
                return _carry_out(*given, choices, save)


@contextmanager
def _alone(archive: Path) -> Iterator[None]:
    """Hold the files of a run. Raises `ValueError` while another process holds them."""
    best = beside(place(archive), BEST)
    if not best.parent.is_dir():
        raise InvalidField("archive", f"must be in a folder that exists; got {archive}")
    lock = best.with_name(f".{best.name}.lock")
    with lock.open("w") as file:
        try:
            # The system releases the lock of a process that is killed.
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            held = not os.fstat(file.fileno()).st_nlink  # One that has just ended removed it.
        except BlockingIOError:
            held = True
        except OSError:  # Some file systems have no locks.
            held = False
        if held:
            raise InvalidField(
                "archive", f"must be one that no other process writes; got {archive}"
            )
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)


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
    known = set(breeding.chosen(state))
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
    save: Callable[[Any], dict[Path, bytes]],
) -> bool:
    saved, pause = time.monotonic(), checkpoint_seconds
    try:
        while not experiment.done(state):
            files = choices.get(state.generation + 1)
            before: Any = state
            if files and isinstance(experiment, Evolution):
                before = experiment.receive(state, "breeding", files)
            state, report = experiment.advance(before, stop)
            tell(report)
            sinks.report(report)
            if time.monotonic() - saved >= pause:
                began = time.monotonic()
                sinks.checkpoint(state.generation, save(state)[archive])
                saved = time.monotonic()
                if checkpoint_seconds:  # 0 asks for a file after every generation.
                    pause = max(checkpoint_seconds, PAUSE_PER_SAVE * (saved - began))
    except Stopped:
        pass
    last, done = save(state), experiment.done(state)
    files = {path.name: data for path, data in last.items()} if done else {}
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


def _refuse_twin(archive: Path) -> None:
    """Raise `ValueError` where another archive has its best creature in the same file."""
    best = beside(archive, BEST)
    if not best.is_file():
        return
    for ending in ("", ".h5", ".hdf5"):
        other = beside(archive, ending)
        if other.name != archive.name and other.is_file() and _holds(other, best):
            raise InvalidField(
                "archive",
                f"must have another name, because {best.name} is of {other.name}; "
                f"got {archive.name}",
            )


def _holds(archive: Path, best: Path) -> bool:
    """Return whether a creature file is of an elite in an archive file."""
    try:
        names = export.columns(archive.read_bytes())["creature"]
        return json.loads(best.read_bytes())["sha256"] in names
    except (ValueError, LookupError, TypeError):  # One of them is a file of something else.
        return False


def _save(
    experiment: Experiment, archive: Path, terms: export.Terms, state: Any
) -> dict[Path, bytes]:
    """Write the archive file, and the best creature beside it; return both."""
    data, best = experiment.save(state), experiment.best(state)
    files = {archive: export.licensed(data, **terms) if terms else data}
    if best is not None:
        files[beside(archive, BEST)] = json.dumps(best | terms, indent=1).encode()
    for path, data in files.items():
        write_whole(path, data)
    return files
