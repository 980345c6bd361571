"""Child processes: start, run, read and end them; signals that ask a process to stop.

Every child is in a group of its own, so that Ctrl-C reaches its parent alone, which ends it in
order. Other users can read arguments, so secrets go through the environment or a pipe.
"""

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import current_thread, main_thread
from types import FrameType
from typing import IO, NamedTuple

PR_SET_PDEATHSIG = 1
PARENT = "MICROCOSMOS_PARENT"
"""The variable in which a child finds the number of the process that started it."""
SHARED_METRICS = "PROMETHEUS_MULTIPROC_DIR"
"""The variable that names a folder in which several processes count together."""
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
STOP_CHECK_SECONDS = 0.5
"""Longest time before `run` notices that it has to stop."""
OUTPUT_LINES = 60
"""Number of last lines to keep: most tracebacks."""
OUTPUT_LINE_LENGTH = 500
"""Characters of a line to keep."""
OUTPUT_SECONDS = 1.0
"""Longest time for the rest of the output after the end of a process."""
# Python has no call for prctl.
_libc = ctypes.CDLL(None, use_errno=True)

# Not an Event: the code that the signal interrupts might hold its lock.
_stop_requested = False


class TooLateError(Exception):
    """A process had no result in time."""


class StoppedError(Exception):
    """A process was ended because its parent has to stop."""


class Finished(NamedTuple):
    """The exit status of a process, its standard output and its standard error."""

    code: int
    output: bytes
    errors: bytes


def python(module: str, *arguments: str) -> list[str]:
    """Return the command that runs a module in the interpreter of this process."""
    return [sys.executable, "-m", module, *arguments]


def start(
    command: Sequence[str],
    environment: Mapping[str, str],
    *,
    stdin: int = subprocess.DEVNULL,
    stdout: int | None = None,
    stderr: int | None = None,
) -> subprocess.Popen[bytes]:
    """Start a process that ends itself by `end_with_parent`, or at the end of its input.

    It suits processes with threads: no code of ours runs between fork and exec, where a lock
    that another thread held would never be released.
    """
    environment = {**environment, PARENT: str(os.getpid())}
    return subprocess.Popen(
        command, env=environment, stdin=stdin, stdout=stdout, stderr=stderr, process_group=0
    )


def start_logged(
    command: Sequence[str],
    environment: Mapping[str, str],
    log: Path,
    *,
    inherit: Sequence[int] = (),
    stdin: int = subprocess.DEVNULL,
) -> subprocess.Popen[bytes]:
    """Start a process that appends its output to a log, and gets SIGTERM when this one dies.

    It suits other programs, such as Redis, which cannot call `end_with_parent`. `inherit`
    names file descriptors. Call it only from a process with a single thread.
    """
    parent = os.getpid()
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("ab") as output:
        return subprocess.Popen(
            command,
            env=dict(environment),
            stdin=stdin,
            stdout=output,
            stderr=output,
            pass_fds=inherit,
            process_group=0,
            preexec_fn=lambda: die_with_parent(parent, signal.SIGTERM),
        )


def run(
    command: Sequence[str],
    environment: Mapping[str, str],
    *,
    stderr: int | None = subprocess.PIPE,
    seconds: float | None = None,
    stop_requested: Callable[[], bool] = lambda: False,
) -> Finished:
    """Run a process to its end and return what it wrote.

    Kill it and raise `TooLateError` after `seconds`, or `StoppedError` once `stop_requested`
    holds.
    """
    process = start(command, environment, stdout=subprocess.PIPE, stderr=stderr)
    deadline = time.monotonic() + seconds if seconds is not None else float("inf")
    try:
        while True:
            left = max(0.0, min(STOP_CHECK_SECONDS, deadline - time.monotonic()))
            with suppress(subprocess.TimeoutExpired):
                # `communicate` loses no output if it is repeated after a timeout.
                output, errors = process.communicate(timeout=left)
                return Finished(process.returncode, output, errors or b"")
            if stop_requested():
                raise StoppedError
            if time.monotonic() >= deadline:
                raise TooLateError
    finally:
        if process.poll() is None:  # Also at Ctrl-C, which did not reach the child.
            signal_group(process, signal.SIGKILL)
            process.communicate()


def signal_group(process: subprocess.Popen[bytes], sent: signal.Signals) -> None:
    """Send a signal to a process and those that it started, unless it has ended."""
    if process.poll() is None:
        os.killpg(process.pid, sent)


def end(process: subprocess.Popen[bytes]) -> None:
    """Kill a process and wait for its end."""
    process.kill()
    process.wait()


def die_with_parent(parent: int, sent: signal.Signals) -> None:
    """Have the kernel send this process a signal when its parent dies, where it can (Linux)."""
    if sys.platform == "linux":
        _libc.prctl(PR_SET_PDEATHSIG, int(sent))
    if os.getppid() != parent:  # The parent died before the call.
        os.kill(os.getpid(), sent)


def end_with_parent() -> None:
    """Have this process killed when the one that started it by `start` dies.

    A process that somebody started by hand has no such parent. The parent must not start it
    from a thread that ends earlier: Linux sends the signal at the end of that thread.
    """
    # Its own children must not take it for theirs.
    if parent := os.environ.pop(PARENT, None):
        die_with_parent(int(parent), signal.SIGKILL)


class Output(threading.Thread):
    """Copies the standard error of a child to this process's own, and keeps the last lines."""

    def __init__(self, process: subprocess.Popen[bytes]):
        super().__init__(name="output of a process", daemon=True)
        assert process.stderr
        self._stream: IO[bytes] = process.stderr
        self._last: deque[str] = deque(maxlen=OUTPUT_LINES)
        self.start()

    def run(self) -> None:
        with self._stream:
            for line in self._stream:
                self._last.append(line.decode(errors="replace").rstrip()[:OUTPUT_LINE_LENGTH])
                # Where the log's disk is full, the child must still find a reader.
                with suppress(OSError):
                    sys.stderr.buffer.write(line)
                    sys.stderr.buffer.flush()

    def tail(self) -> str:
        """Return the last lines of a process that has ended."""
        self.join(OUTPUT_SECONDS)
        return "\n".join(self._last)


def tail(log: Path, lines: int = 5) -> str:
    """Return the last lines of a log, for an error message."""
    if not log.exists():
        return ""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 4096))
        return "\n".join(file.read().decode(errors="replace").splitlines()[-lines:])


def exit_reason(code: int) -> str:
    """Return the end of a process as a predicate, such as `was killed by SIGKILL`."""
    if code >= 0:
        return f"ended with status {code}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else f"signal {-code}"
    # The kernel kills the largest process when memory runs out, and leaves no other trace.
    hint = ", perhaps for lack of memory" if -code == signal.SIGKILL else ""
    return f"was killed by {name}{hint}"


def stop_requested() -> bool:
    """Return True once a signal that `note_stop_signals` handles has asked to stop."""
    return _stop_requested


def note_stop_signals(
    then: Callable[[], None] = lambda: None, *, interrupt: bool = False
) -> None:
    """Note SIGTERM as a request to stop. Note SIGINT if `interrupt`, else ignore it."""

    def note(signum: int, frame: FrameType | None) -> None:
        global _stop_requested
        _stop_requested = True
        then()

    signal.signal(signal.SIGTERM, note)
    signal.signal(signal.SIGINT, note if interrupt else signal.SIG_IGN)


@contextmanager
def on_stop_signal(stop: Callable[[], object]) -> Iterator[None]:
    """Call `stop` at a signal to stop, then the handler that was installed before.

    Uvicorn itself waits for open connections first, which event streams keep open.
    """
    if current_thread() is not main_thread():  # Only the main thread handles signals.
        yield
        return
    before = {number: signal.getsignal(number) for number in STOP_SIGNALS}

    def handle(number: int, frame: FrameType | None) -> None:
        stop()
        earlier = before[signal.Signals(number)]
        if callable(earlier):
            earlier(number, frame)

    for number in STOP_SIGNALS:
        signal.signal(number, handle)
    try:
        yield
    finally:
        for number, earlier in before.items():
            if signal.getsignal(number) is handle:
                signal.signal(number, earlier)
