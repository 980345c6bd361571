"""Locks on folders, held by a process and released when it ends, however it ends."""

import fcntl
import os
import time
from pathlib import Path


class Held(RuntimeError):
    """Another process holds the lock."""


def take(path: Path, patience: float = 0.0) -> int:
    """The descriptor that holds the lock, after waiting at most `patience` seconds for it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    lock = os.open(path, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o600)
    deadline = time.monotonic() + patience
    while True:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return lock
        except BlockingIOError:
            if time.monotonic() >= deadline:
                os.close(lock)
                raise Held(str(path)) from None
            time.sleep(0.05)
