"""`python -m server.tables.migrations`: bring the tables up to date, and end."""

from ...services.services import connect
from ...settings import Settings
from . import upgrade


def main() -> None:
    services = connect(Settings())
    upgrade(services.sessions)
    services.close()


if __name__ == "__main__":
    main()
