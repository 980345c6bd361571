"""Child processes that cannot outlive their parent."""

import ctypes
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

PR_SET_PDEATHSIG = 1
_libc = ctypes.CDLL(None, use_errno=True)


def die_with_parent(parent: int, sent: signal.Signals) -> None:
    """Have the kernel send this process a signal when its parent dies, where it can (Linux)."""
    if sys.platform == "linux":
        _libc.prctl(PR_SET_PDEATHSIG, int(sent))
    if os.getppid() != parent:  # It died before the kernel was told.
        os.kill(os.getpid(), sent)


def spawn(
    arguments: Sequence[str],
    environment: Mapping[str, str],
    log: Path,
    *,
    keep: Sequence[int] = (),
    stdin: int = subprocess.DEVNULL,
) -> subprocess.Popen[bytes]:
    """Start a process in a group of its own, so that a terminal's Ctrl-C reaches only us.

    It is sent SIGTERM when we die, however we die. `keep` names file descriptors to inherit.
    Only for a process that has a single thread.
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
            pass_fds=keep,
            process_group=0,
            preexec_fn=lambda: die_with_parent(parent, signal.SIGTERM),
        )


def tail(log: Path, lines: int = 5) -> str:
    """The last lines of a log, for a message about what went wrong."""
    if not log.exists():
        return ""
    with log.open("rb") as file:
        file.seek(max(0, log.stat().st_size - 4096))
        return "\n".join(file.read().decode(errors="replace").splitlines()[-lines:])


def ending(code: int) -> str:
    """An exit status in words."""
    return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
