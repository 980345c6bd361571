"""`python -m server.tables.migrations`: bring the tables up to date, and end."""

import time

from sqlalchemy.exc import OperationalError

from ...services.services import connect
from ...settings import Settings
from . import upgrade

PATIENCE, PAUSE = 60.0, 2.0
"""Seconds in which a database that does not answer is asked again, and between two attempts."""


def main() -> None:
    services = connect(Settings())
    until = time.monotonic() + PATIENCE
    while True:
        try:
            upgrade(services.sessions)
            break
        except OperationalError as error:
            if time.monotonic() > until:
                raise
            print(f"The database does not answer yet: {error.orig}", flush=True)
            time.sleep(PAUSE)
    services.close()


if __name__ == "__main__":
    main()
