"""`python -m server.main`: start the server alone."""

import sys

import uvicorn

from .auth import bootstrap
from .core import logs
from .services.services import connect
from .settings import Settings, create_private
from .tables import migrations

SHUTDOWN_SECONDS = 5


def main() -> None:
    settings = Settings()
    create_private(settings.data)
    logs.set_up(settings)
    if settings.needs_token:
        services = connect(settings)
        try:
            migrations.upgrade(services.sessions)
            if secret := bootstrap.create_first_token(services):
                print(bootstrap.announcement(settings, secret), flush=True)
        except ValueError as error:
            sys.exit(str(error))
        finally:
            services.close()
    uvicorn.run(
        "server.app:create",
        factory=True,
        host=settings.host,
        port=settings.port,
        timeout_graceful_shutdown=SHUTDOWN_SECONDS,
        log_config=None,
    )


if __name__ == "__main__":
    main()
