"""The sandbox process: handle each request in a child that can open, write and keep nothing.

`python -m microcosmos_server.creatures.sandbox_process` waits for connections on its standard
input and forks for each. A request names a task: `creature` to read a file, `stroke` for its
numbers, or a form in which to write a network. The child may use `MEMORY` beyond its initial
memory, `CPU_SECONDS` of time, and no file.
"""

import json
import os
import resource
import signal
import socket
import struct
import sys
import time
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from microcosmos.archive import creature, creature_h5, pedigree
from microcosmos.naming import FORMAT, encode
from microcosmos.spec import EXPERIMENTS
from microcosmos.spec.creature import CreatureError

from ..core import json_body
from ..core.errors import DomainError, Invalid, Problem, problem_of
from . import networks

# An HDF5 file of 266 kB declared arrays of 400 GB.
MEMORY = 256 << 20
CPU_SECONDS = 1.5
"""Limit on CPU time; time that the process only waits does not count."""
WALL_SECONDS = 5.0
# The server itself goes first on a busy machine.
NICENESS = 10
LENGTH = struct.Struct("<Q")
HDF5 = b"\x89HDF\r\n\x1a\n"
RESULT, PROBLEM = b"result", b"problem"
"""First lines of answers."""


def main() -> None:
    warm_up()
    os.nice(NICENESS)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # Children need no wait.
    with socket.socket(fileno=sys.stdin.fileno()) as control:
        while True:
            _, given, *_ = socket.recv_fds(control, 1, 1)
            if not given:  # The server has ended.
                return
            if os.fork() == 0:
                control.close()
                work(socket.socket(fileno=given[0]))
                # `_exit` skips exit handlers, which belong to the parent.
                os._exit(0)
            os.close(given[0])


def warm_up() -> None:
    """Do each task once: later the child can load nothing. Raise where a task goes wrong."""
    identity = example()
    file = creature.document(identity, None, None)
    read = (creature.canonical(file), creature_h5.dump(creature.parse(file)))
    refused = (b"{}", b"\xff", b"[" * 10_000, HDF5 + bytes(1000))
    written, forms = creature.canonical(identity), [form.encode() for form in networks.FORMS]
    requests = [(b"creature", body, RESULT) for body in read]
    requests += [(b"creature", body, PROBLEM) for body in refused]
    requests += [(form, written, RESULT) for form in forms]
    requests.append((networks.STROKE, creature.canonical(file), RESULT))
    for task, body, expected in requests:
        found = answer(task + b"\n" + body)
        if not found.startswith(expected):
            raise RuntimeError(f"{task!r} must answer {expected!r}, got {found[:200]!r}")


def example() -> dict[str, Any]:
    """Return the identity of a swimmer without hidden nodes, in the demonstration's world."""
    spec: Any = EXPERIMENTS["quality-diversity"].presets[0].spec
    whole, control = spec.model_dump(mode="json"), spec.control
    ends = [*control.inputs, *control.outputs]
    return {
        "format": FORMAT,
        "genome": {
            "encoding": "cppn",
            "inputs": list(control.inputs),
            "outputs": list(control.outputs),
            "control": whole["control"],
            "nodes": {
                "id": list(range(len(ends))),
                "activation": ["identity"] * len(ends),
                "bias": encode(np.zeros(len(ends))),
            },
            "connections": {
                "innovation": [],
                "source": [],
                "target": [],
                "enabled": [],
                "weight": "",
            },
        },
        "world": {
            **spec.world.model_dump(mode="json"),
            "coupling": spec.coupling.model_dump(mode="json"),
        },
        "body": whole["body"],
        "task": whole["task"],
    }


def work(connection: socket.socket) -> None:
    restrict()
    with connection.makefile("rb") as incoming:
        (length,) = LENGTH.unpack(incoming.read(LENGTH.size))
        request = incoming.read(length)
    connection.sendall(answer(request))
    connection.shutdown(socket.SHUT_WR)


def answer(request: bytes) -> bytes:
    """Return the result of a task, or the problem with it."""
    task, _, body = request.partition(b"\n")
    try:
        if task == b"creature":
            return RESULT + b"\n" + json.dumps(creature_file(body)).encode()
        if task == networks.STROKE:
            return RESULT + b"\n" + networks.write_stroke(body)
        return RESULT + b"\n" + networks.write(body, task.decode())
    except (DomainError, CreatureError, ValidationError) as error:
        problem = problem_of(error)
    except MemoryError:
        problem = _unreadable("it needs more memory than any creature file does")
    except Exception as error:  # Any error in a library is the fault of the file.
        problem = _unreadable(f"{type(error).__name__}: {error}")
    return PROBLEM + b"\n" + problem.model_dump_json().encode()


def creature_file(body: bytes) -> dict[str, Any]:
    """Return the checked creature file, with the files of its `ancestors`."""
    if not body.startswith(HDF5):
        return pedigree.document(*pedigree.split(json_body.mapping(json_body.parse(body))))
    try:
        file = creature_h5.load(body)
    except CreatureError:
        raise
    except ValueError as error:
        raise Invalid(f"{error}.", title="Not a creature file") from error
    json_body.refuse_unstorable(file)
    return pedigree.document(file, [])


def _unreadable(why: str) -> Problem:
    detail = f"The file cannot be read: {why:.300}."
    return Problem(title="Unreadable", status=422, detail=detail)


def restrict() -> None:
    """Set the limits for good: a hard limit cannot be raised again."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    room = pages * resource.getpagesize() + MEMORY
    last_second = ceil(time.process_time() + CPU_SECONDS) + 1  # If all else fails.
    for kind, most in (
        (resource.RLIMIT_AS, room),
        (resource.RLIMIT_CPU, last_second),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        # One HDF5 file read a system file through external storage, by plain slicing.
        (resource.RLIMIT_NOFILE, 0),
    ):
        resource.setrlimit(kind, (most, most))
    # By default these signals end the process, even inside a library.
    signal.setitimer(signal.ITIMER_PROF, CPU_SECONDS)
    signal.setitimer(signal.ITIMER_REAL, WALL_SECONDS)


if __name__ == "__main__":
    main()
