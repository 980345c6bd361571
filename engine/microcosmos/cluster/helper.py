"""`python -m microcosmos.cluster.helper URL NAME [--certificate FILE] [--module FILE ...]`:
one device that computes blocks for runs elsewhere.

It proves that it computes rightly before it joins, and joins again when the scheduler was away.
It ends when its standard input does, so that it does not outlive the process that started it.
"""

import argparse
import asyncio
import logging
import os
import sys
import threading
from pathlib import Path

from .. import plugins
from ..device import prepare
from ..doctor import self_test
from .scheduler import HTTP, configured, end_with_signal, security

RETRY_SECONDS = 2.0
PATIENCE = "30s"
"""Time in which the scheduler has to answer."""

log = logging.getLogger("microcosmos.cluster.helper")  # Its own name is `__main__`.


def main() -> None:
    """Join until a signal; end with a sentence and status 1 if the device computes wrongly."""
    arguments = _arguments()
    logging.basicConfig(format="%(asctime)s %(message)s")
    logging.getLogger("microcosmos").setLevel(logging.INFO)
    threading.Thread(target=_end_with_input, daemon=True).start()
    for failed in plugins.load_all(arguments.module):
        log.warning("%s is not loaded: %s", failed.module, failed.reason)
    try:
        prepare(devices=1, cache=arguments.cache)
        wrong = self_test.fault_here()
    except ValueError as error:  # A variable of this host is wrong.
        wrong = str(error)
    if wrong:
        sys.exit(f"{arguments.name} does not join: {wrong}")
    while not asyncio.run(_join(arguments.url, arguments.name, arguments.certificate)):
        log.warning("%s joins again in %.0f s", arguments.name, RETRY_SECONDS)
        threading.Event().wait(RETRY_SECONDS)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    parser.add_argument("url")
    parser.add_argument("name")
    parser.add_argument("--certificate", type=Path)
    parser.add_argument("--cache", type=Path)
    parser.add_argument("--module", type=Path, action="append", default=[])
    return parser.parse_args()


def _end_with_input() -> None:
    # Not by `sys.stdin`, whose lock would be held at the interpreter's own end.
    while os.read(0, 1024):
        pass
    os._exit(0)


async def _join(url: str, name: str, certificate: Path | None) -> bool:
    """Compute until the scheduler or the helper ends; return whether a signal ended it."""
    distributed = configured()
    worker = distributed.Worker(
        url,
        nthreads=1,
        name=name,
        security=security(url, certificate),
        memory_limit=0,
        dashboard=False,
        dashboard_address=HTTP,
        death_timeout=PATIENCE,
    )
    try:
        async with worker:
            ended = end_with_signal(worker)
            log.info("%s has joined %s", name, url)
            await worker.finished()
            return ended.is_set()
    except (TimeoutError, OSError) as error:
        log.warning("the scheduler at %s does not answer: %s", url, error)
        return False


if __name__ == "__main__":
    main()
