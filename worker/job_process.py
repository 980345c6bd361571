"""The process of one job: `python -m worker.job_process RUN WORKER PARENT`."""

import os
import signal
import sys
from uuid import UUID

from server.attempts.claim import NothingComputed, claimed
from server.core import logs
from server.core.processes import die_with_parent
from server.services.services import connect
from server.settings import Settings

from . import process_setup

NICE = 10
"""Niceness of a job, so that the page and replays respond first."""


def main(run_id: str, worker: str, parent: str) -> None:
    die_with_parent(int(parent), signal.SIGKILL)
    settings = Settings()
    logs.set_up(settings)
    logs.bind(run=run_id, worker=worker)
    process_setup.handle_signals()
    claiming = claimed(connect(settings), UUID(run_id), worker, process_setup.stop_requested)
    try:
        with claiming as attempt:
            if attempt:
                logs.bind(attempt=attempt.number)
                # Imported here, so that errors of the engine or its device are recorded.
                from .evolution import carry_out

                os.nice(NICE)  # After the imports, for which the page waits.
                carry_out(attempt)
    except NothingComputed:
        sys.exit(1)  # The supervisor finds out whose fault it is.


if __name__ == "__main__":
    main(*sys.argv[1:])
