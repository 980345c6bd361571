"""Child processes that cannot outlive their parent, and the signals that stop the server."""

import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import current_thread, main_thread
from types import FrameType

PR_SET_PDEATHSIG = 1
SHARED_METRICS = "PROMETHEUS_MULTIPROC_DIR"
"""The variable that names a folder in which several processes count together."""
STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_libc = ctypes.CDLL(None, use_errno=True)


def die_with_parent(parent: int, sent: signal.Signals) -> None:
    """Have the kernel send this process a signal when its parent dies, where it can (Linux)."""
    if sys.platform == "linux":
        _libc.prctl(PR_SET_PDEATHSIG, int(sent))
    if os.getppid() != parent:  # The parent died before the call.
        os.kill(os.getpid(), sent)


def spawn(
    arguments: Sequence[str],
    environment: Mapping[str, str],
    log: Path,
    *,
    inherit: Sequence[int] = (),
    stdin: int = subprocess.DEVNULL,
) -> subprocess.Popen[bytes]:
    """Start a process in a group of its own, which Ctrl-C does not reach.

    The kernel sends it SIGTERM when this process dies. `inherit` names file descriptors. Call
    it only from a process with a single thread.
    """
    parent = os.getpid()
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("ab") as output:
        return subprocess.Popen(
            arguments,
            env=dict(environment),
            stdin=stdin,
            stdout=output,
            stderr=output,
            pass_fds=inherit,
            process_group=0,
            preexec_fn=lambda: die_with_parent(parent, signal.SIGTERM),
        )


def tail(log: Path, lines: int = 5) -> str:
    """Return the last lines of a log, for an error message."""
    if not log.exists():
        return ""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 4096))
        return "\n".join(file.read().decode(errors="replace").splitlines()[-lines:])


def exit_reason(code: int) -> str:
    return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"


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
