"""The process of one job: `python -m microcosmos_worker.job_process RUN WORKER`."""

import logging
import os
import sys
from uuid import UUID

from microcosmos_server.attempts.claim import UNCLAIMED, NothingComputed, Unclaimed, claimed
from microcosmos_server.core import logs
from microcosmos_server.core.processes import (
    end_with_parent,
    note_stop_signals,
    stop_requested,
)
from microcosmos_server.services.services import connect
from microcosmos_server.settings import Settings

log = logging.getLogger(__name__)

NICE = 10
"""Niceness of a job, so that the page and replays respond first."""


def main(run_id: str, worker: str) -> None:
    end_with_parent()
    settings = Settings()
    logs.set_up(settings)
    logs.bind(run=run_id, worker=worker)
    note_stop_signals()
    claiming = claimed(connect(settings), UUID(run_id), worker, stop_requested)
    try:
        with claiming as attempt:
            if attempt:
                logs.bind(attempt=attempt.number)
                # Imported here, so that errors of the engine or its device are recorded.
                from .evolution import carry_out

                os.nice(NICE)  # After the imports, for which the page waits.
                carry_out(attempt)
    except Unclaimed as error:
        log.error("Run %s is not begun: %s", run_id, error.__cause__)
        sys.exit(UNCLAIMED)
    except NothingComputed:
        sys.exit(1)  # The supervisor tests whether the host is at fault.


if __name__ == "__main__":
    main(*sys.argv[1:])
