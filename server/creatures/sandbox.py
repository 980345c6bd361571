"""The server's end of the quarantine, in which files of strangers are read."""

import atexit
import json
import os
import socket
import subprocess
import sys
from contextlib import suppress
from functools import cache
from threading import Lock
from typing import Any

from ..core.errors import RETRY, ProblemError
from ..core.schemas import Problem
from .sandbox_process import LENGTH, SECONDS

PATIENCE = 30.0
"""Seconds for the quarantine to begin, on a machine that is busy; a file has `SECONDS`."""
ENDING = 0.2
"""Seconds within which a process that was killed is known to be gone."""
SINGLE = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "HDF5_PLUGIN_PRELOAD": "::"}
"""A process that forks must have one thread; and HDF5 none of its plugins."""
SECRETS = [f"MICROCOSMOS_{name}_URL" for name in ("DATABASE", "REDIS", "ARTIFACTS")]
SECRETS += ["MICROCOSMOS_TOKEN"]
"""Nothing that is read there may get to know them."""


class Quarantine:
    """A process that reads files for us. It begins at the first, and again if it was ended."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None

    def creature(self, body: bytes) -> dict[str, Any]:
        """The creature file in some bytes; `ProblemError` says why there is none."""
        told = json.loads(self._read(body) or "null")
        if told is None:
            self._refuse_gone()
            detail = (
                "Reading the file took too long, or ended the process that read it; a sound "
                f"one takes much less than {SECONDS:g} seconds."
            )
            raise ProblemError(422, "Unreadable", detail)
        if problem := told.get("problem"):
            raise ProblemError.of(Problem.model_validate(problem))
        return told["file"]

    def _read(self, body: bytes) -> bytes:
        """What the quarantine says of a body; nothing where that was its end."""
        with self._connection() as connection:
            connection.settimeout(PATIENCE)
            try:
                connection.sendall(LENGTH.pack(len(body)) + body)
                with connection.makefile("rb") as answer:
                    return answer.read()
            except (BrokenPipeError, ConnectionResetError):
                return b""

    def _refuse_gone(self) -> None:
        """What does not run, or was ended by somebody, says nothing about a file."""
        with self._lock, suppress(subprocess.TimeoutExpired):
            if self._process:
                self._process.wait(ENDING)
            detail = "Files cannot be read just now; try again."
            raise ProblemError(503, "Unavailable", detail, headers=RETRY)

    def _connection(self) -> socket.socket:
        """To a child of its own for one file."""
        ours, theirs = socket.socketpair()
        with theirs, self._lock:
            try:
                socket.send_fds(self._begun(), [b"\0"], [theirs.fileno()])
            except OSError:  # It was ended.
                self._end()
                socket.send_fds(self._begun(), [b"\0"], [theirs.fileno()])
        return ours

    def begin(self) -> None:
        """Start the process, which takes a second, before somebody waits for it."""
        with self._lock:
            self._begun()

    def _begun(self) -> socket.socket:
        if self._control is None:
            self._control, theirs = socket.socketpair()
            environment = {k: v for k, v in os.environ.items() if k not in SECRETS} | SINGLE
            with theirs:
                command = [sys.executable, "-m", "server.creatures.sandbox_process"]
                self._process = subprocess.Popen(
                    command, stdin=theirs.fileno(), env=environment, process_group=0
                )
        return self._control

    def close(self) -> None:
        with self._lock:
            self._end()

    def _end(self) -> None:
        if self._control and self._process:
            self._control.close()
            self._process.kill()
            self._process.wait()
        self._control = self._process = None


@cache
def quarantine() -> Quarantine:
    """One for all of this process; it keeps nothing from one file to the next."""
    shared = Quarantine()
    atexit.register(shared.close)
    return shared
