"""An installation over a database for all tests, and real servers in threads."""

import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import uvicorn
from connections import Greedy, Marked
from sqlalchemy import update

from microcosmos_server.app import create_app
from microcosmos_server.services import messages
from microcosmos_server.services.services import Services, connect
from microcosmos_server.settings import Settings
from microcosmos_server.storage import mark
from microcosmos_server.tables import Base, InstallationState, migrations

GREEDY = Greedy()
"""What requests of all servers of these tests may not be."""


class Installation:
    """An installation for all tests on one database; its servers start when they are needed."""

    def __init__(self, settings: Settings, stack: ExitStack):
        self.services = connect(settings)
        migrations.upgrade(self.services.sessions)
        mark.leave(self.services.sessions, self.services.artifacts)
        self._stack = stack
        self._addresses: dict[tuple[tuple[str, Any], ...], str] = {}
        stack.callback(self.services.close)

    def served(self, **changes: Any) -> str:
        """Return the address of a server with these changes of the settings.

        It serves all tests: none of them may end it.
        """
        key = tuple(sorted(changes.items()))
        if key not in self._addresses:
            # The server without changes has the settings that tests see, and may patch.
            same = self.services.settings
            settings = same.model_copy(update=changes) if changes else same
            self._addresses[key] = self._stack.enter_context(running(settings))
        return self._addresses[key]

    def clean(self) -> None:
        messages.flush()
        with self.services.sessions.write.begin() as session:
            for table in reversed(Base.metadata.sorted_tables):
                if table.name != InstallationState.__tablename__:
                    session.execute(table.delete())
            session.execute(update(InstallationState).values(keep_files_until=None))
        empty_redis(self.services)
        shutil.rmtree(self.services.settings.artifacts, ignore_errors=True)
        mark.leave(self.services.sessions, self.services.artifacts)


def empty_redis(services: Services) -> None:
    for queue in (services.jobs.renderings, services.jobs.audits):
        queue.delete(delete_jobs=True)
    pattern = f"*{services.settings.redis_prefix[:-1]}*"
    if keys := list(services.redis.scan_iter(pattern, count=1000)):
        services.redis.delete(*keys)


@contextmanager
def running(settings: Settings) -> Iterator[str]:
    """Run a server in a thread; yield its address."""
    services = connect(settings)
    GREEDY.watch(services.sessions.engine)
    GREEDY.watch_store(services.artifacts)
    app = create_app(services)
    config = uvicorn.Config(
        Marked(app), port=0, log_level="warning", timeout_graceful_shutdown=5
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        assert thread.is_alive(), "the server did not start"
        time.sleep(0.01)
    port = server.servers[0].sockets[0].getsockname()[1]
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        app.state.end_streams()  # As a signal would in the main thread.
        server.should_exit = True
        thread.join()
