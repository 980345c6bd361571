"""Carry out the runs of a study on this machine, in this process or in several.

A worker reads runs as lines of JSON from its standard input and writes its progress to its
standard output. When the input closes, because the study has ended, was stopped or was killed,
it writes a checkpoint and ends.
"""

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import IO, Any, NamedTuple

from ..archive.atomic import write_whole
from ..search import never
from ..spec import estimate
from .runs import Plan, PlannedRun, of_run

SPEED = "speed.json"
"""File of the measured speed: it serves estimates alone."""

Tell = Callable[["Progress"], None]


@dataclass
class Progress:
    """Progress of a study, in runs and in fluid cells times steps."""

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
        """Return the estimated time to the end, None before anything is done."""
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
    it. Raises `ValueError` where a run fails, or begins with creatures, whose files a study
    lacks.
    """
    runs = plan.unique()
    progress = begun(runs)
    left = [run for run in runs if not run.done()[1]]
    _refuse_initial(left)
    tell(progress)
    began_at, before = time.monotonic(), progress.done

    def heard(run: PlannedRun, generation: int) -> None:
        share = min(1.0, generation / run.spec.generations)
        progress.shares[run.id] = share * estimate(run.spec).cell_steps
        tell(progress)

    def ended(run: PlannedRun) -> None:
        heard(run, run.spec.generations)
        progress.finished += 1
        tell(progress)
        if work := progress.done - before:  # A run that lacked its end alone has none.
            speed = work / (time.monotonic() - began_at) / min(processes, len(left))
            document = {"cell_steps_per_second": speed}  # Of one process.
            write_whole(plan.folder / SPEED, json.dumps(document).encode())

    # One run at a time needs no second process, which would load JAX again.
    if processes == 1 or len(left) < 2:
        return all(_here(run, heard, ended, stop, checkpoint_seconds) for run in left)
    count = min(processes, len(left))
    options = Options(count, checkpoint_seconds, str(cache) if cache else None)
    with ExitStack() as stack:
        workers = start_workers(stack, options, modules)
        return distribute(workers, left, heard, ended, stop)


def _refuse_initial(runs: Sequence[PlannedRun]) -> None:
    """Raise `ValueError`, before the first of the runs, for one that cannot begin here."""
    for run in runs:
        if (count := len(run.spec.search.initial)) and not run.path.exists():
            raise ValueError(
                f"run {run.id}: `search.initial` must be empty for a study on this machine, "
                f"got {count}; a server has the creatures' files (--server)"
            )


def begun(runs: Sequence[PlannedRun]) -> Progress:
    """Return the progress of the runs."""
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

    with run.named(), of_run(run.path):
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


def estimated_seconds(plan: Plan, processes: int) -> float | None:
    """Return the time of what is left, by the speed of this study's runs; None before those,
    and where the file of the speed is damaged."""
    progress = begun(plan.unique())
    left = progress.runs - progress.finished
    if not left or progress.done >= progress.work:
        return 0.0
    try:
        document = json.loads((plan.folder / SPEED).read_bytes())
        speed = float(document["cell_steps_per_second"])
    except (FileNotFoundError, ValueError, LookupError, TypeError):
        return None
    if not 0 < speed < inf:
        return None
    return (progress.work - progress.done) / speed / min(processes, left)


PAUSE = 0.2
"""Seconds between two looks at whether the study is to stop."""
ENDING = 10.0
"""Seconds in which a worker whose output has closed ends."""
PATIENCE = 120.0
"""Seconds in which a worker writes its checkpoint."""


class Options(NamedTuple):
    """Options of all workers."""

    processes: int
    """Their number, among which they divide the cores."""
    checkpoint_seconds: float
    cache: str | None
    """The folder of compiled programs."""


class Worker(NamedTuple):
    process: "subprocess.Popen[str]"
    messages: "SimpleQueue[tuple[int, dict[str, Any] | None]]"
    """Messages of all workers: number and line, None at the end."""


def start_workers(stack: ExitStack, options: Options, modules: Sequence[Path]) -> list[Worker]:
    """Start workers, which end with the stack."""
    messages: SimpleQueue[tuple[int, dict[str, Any] | None]] = SimpleQueue()
    command = [sys.executable, "-m", f"{__package__}.worker", json.dumps(options._asdict())]
    workers = []
    for number in range(options.processes):
        process = subprocess.Popen(
            [*command, *map(str, modules)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,  # Ctrl-C reaches the study alone, which closes the input.
        )
        # No worker outlives the study, even after an exception
        # (test_a_study_killed_twice_ends_with_the_same_bytes).
        stack.callback(_end, process)
        assert process.stdout is not None
        Thread(target=_listen, args=(number, process.stdout, messages), daemon=True).start()
        workers.append(Worker(process, messages))
    return workers


def distribute(
    workers: Sequence[Worker],
    runs: Sequence[PlannedRun],
    heard: Callable[[PlannedRun, int], None],
    ended: Callable[[PlannedRun], None],
    stop: Callable[[], bool],
) -> bool:
    """Give each worker a run after the other; return whether all are finished.

    Raises `ValueError` where a run fails or a worker dies.
    """
    waiting, busy = iter(runs), {}
    for number in range(len(workers)):
        _give(workers, number, waiting, busy)
    while busy:
        if stop():
            return False
        try:
            number, line = workers[0].messages.get(timeout=PAUSE)
        except Empty:
            continue
        run = busy[number]
        if line is None:
            # The study ends all workers, also one that lives and whose output is no message.
            with suppress(subprocess.TimeoutExpired):
                status = workers[number].process.wait(ENDING)
                raise ValueError(f"run {run.id}: its process ended with status {status}")
            raise ValueError(f"run {run.id}: its process wrote what is no message")
        if "error" in line:
            raise ValueError(f"run {run.id}: {line['error']}")
        if "generation" in line:
            heard(run, line["generation"])
        else:
            ended(run)
            _give(workers, number, waiting, busy)
    return True


def _give(
    workers: Sequence[Worker],
    number: int,
    waiting: Iterator[PlannedRun],
    busy: dict[int, PlannedRun],
) -> None:
    run = next(waiting, None)
    if run is None:
        busy.pop(number, None)
        return
    busy[number] = run
    request = {"spec": run.spec.model_dump(mode="json"), "path": str(run.path)}
    stdin = workers[number].process.stdin
    assert stdin is not None
    try:
        stdin.write(f"{json.dumps(request)}\n")
        stdin.flush()
    except BrokenPipeError:
        pass  # The worker has died, which the end of its output tells.


def _listen(number: int, stdout: IO[str], messages: SimpleQueue) -> None:
    try:
        for line in stdout:
            messages.put((number, json.loads(line)))
    finally:
        messages.put((number, None))


def _end(process: "subprocess.Popen[str]") -> None:
    assert process.stdin is not None
    with suppress(BrokenPipeError):
        process.stdin.close()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        # A worker that hangs keeps its last checkpoint, from which the next call goes on.
        process.kill()
        process.wait()
