"""`python -m server.main`: start the server alone."""

import sys

import uvicorn

from .auth import bootstrap
from .core.folders import private
from .services.services import connect
from .settings import Settings
from .tables import migrations

GRACE = 5
"""Seconds that open connections have to end."""


def main() -> None:
    settings = Settings()
    private(settings.data)
    if settings.needs_token:
        _prepare(settings)
    uvicorn.run(
        "server.app:create",
        factory=True,
        host=settings.host,
        port=settings.port,
        timeout_graceful_shutdown=GRACE,
    )


def _prepare(settings: Settings) -> None:
    """Before anybody is answered there is a token, which is told where it is new."""
    services = connect(settings)
    try:
        migrations.upgrade(services.sessions)
        if secret := bootstrap.begin(services):
            print(bootstrap.told(settings, secret), flush=True)
    except ValueError as error:
        sys.exit(str(error))
    finally:
        services.close()


if __name__ == "__main__":
    main()
