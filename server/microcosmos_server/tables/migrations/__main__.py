"""`python -m microcosmos_server.tables.migrations`: bring the tables up to date, and end."""

import sys
import time

from sqlalchemy.exc import OperationalError

from ...core.database import connect
from ...settings import from_environment
from . import SchemaError, upgrade

# A database that starts together with this container needs a while
# (tests/server/test_compose.py).
WAIT_SECONDS, RETRY_SECONDS = 60.0, 2.0
"""Seconds to wait for a database that does not answer, and between two attempts."""


def main() -> None:
    sessions = connect(from_environment().database)
    until = time.monotonic() + WAIT_SECONDS
    while True:
        try:
            upgrade(sessions)
            break
        except SchemaError as error:
            sys.exit(str(error))
        except OperationalError as error:
            if time.monotonic() > until:
                sys.exit(f"The database does not answer: {error.orig}")
            print(f"The database does not answer yet: {error.orig}", flush=True)
            time.sleep(RETRY_SECONDS)
    sessions.engine.dispose()


if __name__ == "__main__":
    main()
