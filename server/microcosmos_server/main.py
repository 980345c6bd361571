"""`python -m microcosmos_server.main`: start the server alone, in one process or several."""

import os
import sys
import tempfile

import uvicorn
from sqlalchemy.exc import OperationalError

from .auth import bootstrap
from .core import logs
from .core.connections import Connection
from .core.processes import SHARED_METRICS
from .services.services import connect
from .settings import Settings, create_data_folder, from_environment
from .tables import migrations

# Event streams do not end by themselves, and uvicorn waits for open connections.
SHUTDOWN_SECONDS = 5
SILENT_SECONDS = 30
"""Seconds after which one of several processes that does not answer is replaced."""


def main() -> None:
    settings = from_environment()
    create_data_folder(settings)
    logs.set_up(settings)
    # Here too, though each process does so at its start: there an error is a traceback.
    services = connect(settings)
    try:
        migrations.upgrade(services.sessions)
        if secret := bootstrap.create_first_token(services):
            print(bootstrap.announcement(settings, secret), flush=True)
    except OperationalError as error:
        sys.exit(f"The database {services.sessions.engine.url!r} does not answer: {error.orig}")
    except (ValueError, migrations.SchemaError) as error:
        sys.exit(str(error))
    finally:
        services.close()
    with tempfile.TemporaryDirectory(prefix="microcosmos-metrics-") as counted:
        if settings.servers > 1:
            # prometheus_client reads it when the processes import it.
            os.environ[SHARED_METRICS] = counted
        serve(settings)


def serve(settings: Settings) -> None:
    """Serve until a signal; several processes share the port, and dead ones are replaced."""
    uvicorn.run(
        "microcosmos_server.app:create",
        factory=True,
        host=settings.host,
        port=settings.port,
        workers=settings.servers,
        http=Connection,
        timeout_graceful_shutdown=SHUTDOWN_SECONDS,
        # With uvicorn's own configuration its lines would pass by our handler, which leaves
        # secrets out.
        log_config=None,
        timeout_worker_healthcheck=SILENT_SECONDS,
    )


if __name__ == "__main__":
    main()
