"""`python -m server.tables.migrations`: bring the tables up to date, and end."""

import time

from sqlalchemy.exc import OperationalError

from ...core.database import connect
from ...settings import Settings
from . import upgrade

WAIT_SECONDS, RETRY_SECONDS = 60.0, 2.0
"""Seconds to wait for a database that does not answer, and between two attempts."""


def main() -> None:
    sessions = connect(Settings().database)
    until = time.monotonic() + WAIT_SECONDS
    while True:
        try:
            upgrade(sessions)
            break
        except OperationalError as error:
            if time.monotonic() > until:
                raise
            print(f"The database does not answer yet: {error.orig}", flush=True)
            time.sleep(RETRY_SECONDS)
    sessions.engine.dispose()


if __name__ == "__main__":
    main()
