"""A run in progress to back up, and empty installations to restore it into."""

from contextlib import ExitStack, closing

import pytest
from databases import own_postgresql

from microcosmos.archive import creature
from microcosmos_server.renderings.storage import save
from microcosmos_server.services.services import connect
from microcosmos_server.tables import GIF
from microcosmos_server.workers import registry


@pytest.fixture
def running(services, attempt, record, identity) -> str:
    """A run in progress with checkpoints, whose elite has a film; returns the elite."""
    registry.report(services.sessions, "worker", "a device", 1, "busy")
    for generation in range(1, 6):
        record(generation, {0: float(generation)})
        attempt.save(generation, b"state %d" % generation)
    record(6, {6: 1.0})
    name = creature.name(identity(1000))
    save(services, name, GIF, b"a film")
    return name


@pytest.fixture
def elsewhere(services, tmp_path, database):
    """Makes empty installations on databases of the same kind."""
    with ExitStack() as stack:

        def make(**changes):
            url = f"sqlite:///{tmp_path / 'other' / 'other.sqlite'}"
            if database == "postgresql":
                url = stack.enter_context(own_postgresql())
            changes = {"artifacts_url": str(tmp_path / "other" / "files")} | changes
            changes |= {"data": tmp_path / "other", "database_url": url}
            settings = services.settings.model_copy(update=changes)
            return stack.enter_context(closing(connect(settings)))

        yield make
