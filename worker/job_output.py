"""Pass on what a job writes to its standard error, and keep the last lines."""

import subprocess
import sys
import threading
from collections import deque
from typing import IO

LINES = 60
"""Number of lines to keep: most tracebacks."""
LONGEST = 500
"""Characters of a line to keep."""
WAIT_SECONDS = 1.0
"""Longest time for the rest of the output after the end of a job."""


class JobOutput(threading.Thread):
    """Copies the output of a job to this process's own."""

    def __init__(self, job: subprocess.Popen[bytes]):
        super().__init__(name="job output", daemon=True)
        assert job.stderr
        self._stream: IO[bytes] = job.stderr
        self._last: deque[str] = deque(maxlen=LINES)
        self.start()

    def run(self) -> None:
        with self._stream:
            for line in self._stream:
                self._last.append(line.decode(errors="replace").rstrip()[:LONGEST])
                sys.stderr.buffer.write(line)
                sys.stderr.buffer.flush()

    def tail(self) -> str:
        """Return the last lines of a job that has ended."""
        self.join(WAIT_SECONDS)
        return "\n".join(self._last)
