"""`python -m server.main`: start the server alone, in one process or several."""

import os
import sys
import tempfile

import uvicorn
from pydantic import ValidationError

from .auth import bootstrap
from .core import logs
from .core.processes import SHARED_METRICS
from .services.services import connect
from .settings import Settings, create_private, explain
from .tables import migrations

SHUTDOWN_SECONDS = 5
SILENT_SECONDS = 30
"""Seconds after which one of several processes that does not answer is replaced."""


def main() -> None:
    try:
        settings = Settings()
    except ValidationError as error:
        sys.exit(explain(error))
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
    with tempfile.TemporaryDirectory(prefix="microcosmos-metrics-") as counted:
        if settings.servers > 1:
            os.environ[SHARED_METRICS] = counted
        serve(settings)


def serve(settings: Settings) -> None:
    """Serve until a signal; several processes share the port, and dead ones are replaced."""
    uvicorn.run(
        "server.app:create",
        factory=True,
        host=settings.host,
        port=settings.port,
        workers=settings.servers,
        timeout_graceful_shutdown=SHUTDOWN_SECONDS,
        log_config=None,
        timeout_worker_healthcheck=SILENT_SECONDS,
    )


if __name__ == "__main__":
    main()
