"""The sandbox: a process that reads uploaded files and runs the code of networks."""

import atexit
import json
import os
import socket
import subprocess
from contextlib import suppress
from functools import cache
from threading import Lock
from typing import Any

from ..core import processes
from ..core.errors import RETRY_AFTER, Invalid, Problem, Relayed, Unavailable
from .networks import STROKE
from .sandbox_process import CPU_SECONDS, LENGTH, PROBLEM, RESULT

START_SECONDS = 30.0
"""Time for the process to start on a busy machine. One request has `CPU_SECONDS`."""
END_SECONDS = 0.2
"""Time to wait for the end of a killed process."""
# A process that forks must have one thread, and HDF5 must load no plug-in.
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "HDF5_PLUGIN_PRELOAD": "::"}
INHERITED = ("PATH", "HOME", "TMPDIR", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "LD_LIBRARY_PATH")
INHERITED += ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "PYTHONDONTWRITEBYTECODE")
INHERITED += ("MICROCOSMOS_DATA",)  # Whose process this is.
"""Variables that the process inherits; any other may be a secret, or become one."""


class Sandbox:
    """Starts the process at the first request, and again if it has ended."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None

    def creature(self, body: bytes) -> dict[str, Any]:
        """Return the creature file in some bytes; raise `DomainError` if there is none."""
        return json.loads(self._result(b"creature\n" + body, "Reading the file"))

    def network(self, identity: bytes, form: str) -> bytes:
        """Return a creature's network in a form; raise `DomainError` if that fails."""
        return self._result(form.encode() + b"\n" + identity, "Writing the network")

    def stroke(self, file: bytes) -> bytes:
        """Return length, stroke and sperm number of a creature as JSON, null without a stroke.

        `file` has its `identity` and what it `measured`.
        """
        return self._result(STROKE + b"\n" + file, "Growing the body")

    def _result(self, request: bytes, action: str) -> bytes:
        status, _, content = self._read(request).partition(b"\n")
        if status == PROBLEM:
            raise Relayed(Problem.model_validate_json(content))
        if status != RESULT:
            with self._lock, suppress(subprocess.TimeoutExpired):
                if self._process:
                    self._process.wait(END_SECONDS)
                # The whole process has ended, not the request alone.
                detail = "The sandbox of the server does not answer; try again."
                raise Unavailable(detail, headers=RETRY_AFTER)
            detail = f"{action} took more than {CPU_SECONDS:g} seconds or too much memory."
            raise Invalid(detail, title="Unreadable")
        return content

    def _read(self, request: bytes) -> bytes:
        """Return the answer of the sandbox, empty if the request ended its process."""
        with self._connection() as connection:
            connection.settimeout(START_SECONDS)
            try:
                connection.sendall(LENGTH.pack(len(request)) + request)
                with connection.makefile("rb") as answer:
                    return answer.read()
            except (BrokenPipeError, ConnectionResetError):
                return b""

    def _connection(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs, self._lock:
            try:
                socket.send_fds(self._ensure_started(), [b"\0"], [theirs.fileno()])
            except OSError:  # The process has ended.
                self._end()
                socket.send_fds(self._ensure_started(), [b"\0"], [theirs.fileno()])
        return ours

    def start(self) -> None:
        """Start the process, which takes a second, before the first request."""
        with self._lock:
            self._ensure_started()

    def _ensure_started(self) -> socket.socket:
        if self._control is None:
            self._control, theirs = socket.socketpair()
            environment = {k: os.environ[k] for k in INHERITED if k in os.environ} | ONE_THREAD
            with theirs:
                # It ends with its input. The kernel cannot bind it to this process: a request's
                # thread starts it, and the end of that thread would count as its parent's.
                command = processes.python("microcosmos_server.creatures.sandbox_process")
                self._process = processes.start(command, environment, stdin=theirs.fileno())
        return self._control

    def close(self) -> None:
        with self._lock:
            self._end()

    def _end(self) -> None:
        if self._control and self._process:
            self._control.close()
            processes.end(self._process)
        self._control = self._process = None


@cache
def sandbox() -> Sandbox:
    """Return the sandbox of this process. It keeps nothing between two requests."""
    shared = Sandbox()
    atexit.register(shared.close)
    return shared
