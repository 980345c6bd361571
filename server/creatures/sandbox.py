"""The sandbox: a process that reads uploaded files and runs the code of networks."""

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

from ..core.errors import RETRY_AFTER, Problem, ProblemError
from . import strokes
from .sandbox_process import CPU_SECONDS, LENGTH, PROBLEM, RESULT

START_SECONDS = 30.0
"""Time for the process to start on a busy machine. One request has `CPU_SECONDS`."""
END_SECONDS = 0.2
"""Time to wait for the end of a killed process."""
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "HDF5_PLUGIN_PRELOAD": "::"}
"""A process that forks must have one thread, and HDF5 must load no plug-in."""
SECRETS = [f"MICROCOSMOS_{name}_URL" for name in ("DATABASE", "REDIS", "ARTIFACTS")]
SECRETS += ["MICROCOSMOS_TOKEN", "WANDB_API_KEY"]
SECRETS += [f"MLFLOW_TRACKING_{name}" for name in ("USERNAME", "PASSWORD", "TOKEN")]
"""Variables that the process does not inherit."""


class Sandbox:
    """Starts the process at the first request, and again if it has ended."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None

    def creature(self, body: bytes) -> dict[str, Any]:
        """Return the creature file in some bytes; raise `ProblemError` if there is none."""
        return json.loads(self._result(b"creature\n" + body, "Reading the file"))

    def network(self, identity: bytes, form: str) -> bytes:
        """Return a creature's network in a form; raise `ProblemError` if that fails."""
        return self._result(form.encode() + b"\n" + identity, "Writing the network")

    def stroke(self, identity: bytes) -> bytes:
        """Return a creature's length, stroke and sperm number as JSON; raise `ProblemError` for
        one without a stroke."""
        return self._result(strokes.FORM.encode() + b"\n" + identity, "Growing the body")

    def _result(self, request: bytes, action: str) -> bytes:
        status, _, content = self._read(request).partition(b"\n")
        if status == PROBLEM:
            raise ProblemError.of(Problem.model_validate_json(content))
        if status != RESULT:
            with self._lock, suppress(subprocess.TimeoutExpired):
                if self._process:
                    self._process.wait(END_SECONDS)
                # The whole process has ended, not the request alone.
                detail = "The sandbox of the server does not answer; try again."
                raise ProblemError(503, "Unavailable", detail, headers=RETRY_AFTER)
            detail = f"{action} took more than {CPU_SECONDS:g} seconds or too much memory."
            raise ProblemError(422, "Unreadable", detail)
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
            environment = {k: v for k, v in os.environ.items() if k not in SECRETS} | ONE_THREAD
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
def sandbox() -> Sandbox:
    """Return the sandbox of this process. It keeps nothing between two requests."""
    shared = Sandbox()
    atexit.register(shared.close)
    return shared
