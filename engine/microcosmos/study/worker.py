"""A process that carries out runs of a study: `python -m microcosmos.study.worker`."""

import json
import os
import sys
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Thread
from typing import Any

from .. import plugins
from ..build import local
from ..device import cores, prepare
from ..spec import parse
from .local import Options
from .runs import of_run


def main(options: Options, modules: list[str]) -> None:
    """Carry out the runs that the standard input names, until it closes."""
    # Others may write to the standard output, such as plug-ins and libraries in C.
    out = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    plugins.load_all(())
    for module in modules:
        plugins.load(Path(module))
    # Workers share the cores; more devices than cores would slow each other down.
    prepare(max(1, cores() // options.processes), options.cache)
    requests: SimpleQueue[str | None] = SimpleQueue()
    closed = Event()
    Thread(target=_listen, args=(requests, closed), daemon=True).start()

    def say(**line: Any) -> None:
        try:
            print(json.dumps(line), file=out, flush=True)
        except BrokenPipeError:
            closed.set()  # The study has ended.

    while (line := requests.get()) is not None and not closed.is_set():
        run = json.loads(line)
        try:
            path = Path(run["path"])
            with of_run(path):
                done = local.evolve(
                    parse(run["spec"]),
                    path,
                    stop=closed.is_set,
                    tell=lambda report: say(generation=report.generation),
                    checkpoint_seconds=options.checkpoint_seconds,
                )
            if done:
                say(done=True)
        except (ValueError, OSError) as error:
            say(error=str(error))


def _listen(requests: "SimpleQueue[str | None]", closed: Event) -> None:
    for line in sys.stdin:
        requests.put(line)
    # First the flag, which stops the run that is under way.
    closed.set()
    requests.put(None)


if __name__ == "__main__":
    main(Options(**json.loads(sys.argv[1])), sys.argv[2:])
