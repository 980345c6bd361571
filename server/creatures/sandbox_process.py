"""Where files of strangers are read: each in a process that can open, write and keep nothing.

`python -m server.creatures.sandbox_process` waits for connections on its standard input and
forks for each.
The child may have no more memory than it began with and `MEMORY`, no more time than `SECONDS`,
and no file at all: whatever path a file names, the kernel refuses to open it.
"""

import os
import resource
import signal
import socket
import struct
import sys
import time
from math import ceil
from pathlib import Path

from microcosmos.archive import creature, creature_h5

from . import files
from .probe import example

MEMORY = 256 << 20
SECONDS = 1.5
"""Of computing; a busy machine is no fault of the file."""
ALL_SECONDS = 5.0
"""With all waiting, of which there should be none."""
LENGTH = struct.Struct("<Q")


def main() -> None:
    warm_up()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # Nobody waits for them.
    with socket.socket(fileno=sys.stdin.fileno()) as control:
        while True:
            _, given, *_ = socket.recv_fds(control, 1, 1)
            if not given:  # The server has ended.
                return
            if os.fork() == 0:
                control.close()
                work(socket.socket(fileno=given[0]))
                os._exit(0)
            os.close(given[0])


def warm_up() -> None:
    """Read one of each kind: afterwards nothing has to be loaded, for nothing can be."""
    file = creature.document(example(), None, None)
    whole = creature.parse(file)
    for body in (creature.canonical(file), creature_h5.dump(whole)):
        assert b'"file"' in files.answer(body)[:10]
    for body in (b"{}", b"\xff", b"[" * 10_000, files.HDF5 + bytes(1000)):
        assert b'"problem"' in files.answer(body)[:12]


def work(connection: socket.socket) -> None:
    """Read a body, answer it, and be gone."""
    restrict()
    with connection.makefile("rb") as incoming:
        (length,) = LENGTH.unpack(incoming.read(LENGTH.size))
        body = incoming.read(length)
    connection.sendall(files.answer(body))
    connection.shutdown(socket.SHUT_WR)


def restrict() -> None:
    """For good: a hard limit cannot be raised again."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    room = pages * resource.getpagesize() + MEMORY
    for kind, most in (
        (resource.RLIMIT_AS, room),
        (resource.RLIMIT_CPU, ceil(time.process_time() + SECONDS) + 1),  # If all else fails.
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, 0),
    ):
        resource.setrlimit(kind, (most, most))
    # Their default is to end the process, also one that is or waits within a library.
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    signal.setitimer(signal.ITIMER_REAL, ALL_SECONDS)


if __name__ == "__main__":
    main()
