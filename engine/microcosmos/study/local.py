"""Carry out the runs of a study on this machine, in this process or in several."""

import json
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from ..archive.atomic import write_whole
from ..search import never
from ..spec import estimate
from . import pool
from .lock import of_run
from .runs import Plan, PlannedRun

SPEED = "speed.json"
"""File of the measured speed: it serves estimates alone."""

Tell = Callable[["Progress"], None]


@dataclass
class Progress:
    """How far a study is, in runs and in fluid cells times steps."""

    runs: int
    work: float
    finished: int = 0
    before: float = 0.0
    """Work that was done before this process."""
    shares: dict[str, float] = field(default_factory=dict)
    """Work done of each run."""
    begun: float = field(default_factory=time.monotonic)

    @property
    def done(self) -> float:
        return sum(self.shares.values())

    @property
    def seconds_left(self) -> float | None:
        """Estimated time to the end, None before anything is done."""
        own, passed = self.done - self.before, time.monotonic() - self.begun
        return None if own <= 0 else (self.work - self.done) * passed / own


def carry_out(
    plan: Plan,
    *,
    processes: int = 1,
    tell: Tell = lambda progress: None,
    stop: Callable[[], bool] = never,
    modules: Sequence[Path] = (),
    checkpoint_seconds: float = 20.0,
    cache: Path | None = None,
) -> bool:
    """Carry out the runs that are not finished; return whether all are.

    A run continues from its file, and ends with the bytes of an uninterrupted one. With several
    processes, each carries out one run at a time; all end where this one ends, whatever ends
    it. Raises `ValueError` where a run fails.
    """
    runs = plan.unique()
    progress = begun(runs)
    left = [run for run in runs if not run.done()[1]]
    tell(progress)
    started, before = time.monotonic(), progress.done

    def heard(run: PlannedRun, generation: int) -> None:
        share = min(1.0, generation / run.spec.generations)
        progress.shares[run.id] = share * estimate(run.spec).cell_steps
        tell(progress)

    def ended(run: PlannedRun) -> None:
        heard(run, run.spec.generations)
        progress.finished += 1
        tell(progress)
        work = progress.done - before
        _remember(plan.folder, work / (time.monotonic() - started) / min(processes, len(left)))

    if processes == 1 or len(left) < 2:
        return all(_here(run, heard, ended, stop, checkpoint_seconds) for run in left)
    count = min(processes, len(left))
    options = pool.Options(count, checkpoint_seconds, str(cache) if cache else None)
    with ExitStack() as stack:
        workers = pool.started(stack, options, modules)
        return pool.share(workers, left, heard, ended, stop)


def begun(runs: Sequence[PlannedRun]) -> Progress:
    """Return how far the runs are."""
    progress = Progress(len(runs), 0.0)
    for run in runs:
        work = float(estimate(run.spec).cell_steps)
        generation, finished = run.done()
        progress.work += work
        share = 1.0 if finished else generation / run.spec.generations
        progress.shares[run.id] = share * work
        progress.finished += finished
    progress.before = progress.done
    return progress


def _here(
    run: PlannedRun,
    heard: Callable[[PlannedRun, int], None],
    ended: Callable[[PlannedRun], None],
    stop: Callable[[], bool],
    checkpoint_seconds: float,
) -> bool:
    from ..build import local  # Loads JAX.

    with of_run(run.path):
        done = local.evolve(
            run.spec,
            run.path,
            stop=stop,
            tell=lambda report: heard(run, report.generation),
            checkpoint_seconds=checkpoint_seconds,
        )
    if done:
        ended(run)
    return done


def _remember(folder: Path, speed: float) -> None:
    """Write the fluid cells times steps a second of one process."""
    write_whole(folder / SPEED, json.dumps({"cell_steps_per_second": speed}).encode())


def estimated_seconds(plan: Plan, processes: int) -> float | None:
    """Return the time of what is left, by the speed of this study's runs; None before those."""
    try:
        speed = json.loads((plan.folder / SPEED).read_bytes())["cell_steps_per_second"]
    except FileNotFoundError:
        return None
    progress = begun(plan.unique())
    return (progress.work - progress.done) / speed / processes
