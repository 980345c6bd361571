"""Processes that carry out runs of a study, one at a time each.

A worker reads runs as lines of JSON from its standard input and writes its progress to its
standard output. When the input closes, because the study has ended, was stopped or was killed,
it writes a checkpoint and ends.
"""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import IO, Any, NamedTuple

from .runs import PlannedRun

PAUSE = 0.2
"""Seconds between two looks at whether the study is to stop."""
PATIENCE = 120.0
"""Seconds in which a worker writes its checkpoint."""


class Options(NamedTuple):
    """What all workers share."""

    processes: int
    """Their number, among which they divide the cores."""
    checkpoint_seconds: float
    cache: str | None
    """The folder of compiled programs."""


class Worker(NamedTuple):
    process: "subprocess.Popen[str]"
    said: "SimpleQueue[tuple[int, dict[str, Any] | None]]"
    """Of all workers: number and line, None at the end."""


def started(stack: ExitStack, options: Options, modules: Sequence[Path]) -> list[Worker]:
    """Start workers, which end with the stack."""
    said: SimpleQueue[tuple[int, dict[str, Any] | None]] = SimpleQueue()
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
        stack.callback(_end, process)
        assert process.stdout is not None
        Thread(target=_listen, args=(number, process.stdout, said), daemon=True).start()
        workers.append(Worker(process, said))
    return workers


def share(
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
            number, line = workers[0].said.get(timeout=PAUSE)
        except Empty:
            continue
        run = busy[number]
        if line is None:
            status = workers[number].process.wait(PATIENCE)
            raise ValueError(f"run {run.id}: its process ended with status {status}")
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
    asked = {"spec": run.spec.model_dump(mode="json"), "path": str(run.path)}
    stdin = workers[number].process.stdin
    assert stdin is not None
    try:
        stdin.write(f"{json.dumps(asked)}\n")
        stdin.flush()
    except BrokenPipeError:
        pass  # The worker has died, which the end of its output tells.


def _listen(number: int, stdout: IO[str], said: SimpleQueue) -> None:
    for line in stdout:
        said.put((number, json.loads(line)))
    said.put((number, None))


def _end(process: "subprocess.Popen[str]") -> None:
    assert process.stdin is not None
    with suppress(BrokenPipeError):
        process.stdin.close()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
