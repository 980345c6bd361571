"""Fixtures of queued runs and of the workers that take them; they need `services` and `api`."""

from collections.abc import Callable
from typing import Any

import pytest
from sqlalchemy import select

from microcosmos_server.schedule.order import places
from microcosmos_server.schedule.take import take
from microcosmos_server.workers import registry


@pytest.fixture
def waiting(services) -> Callable[[], list[str]]:
    """Returns the ids of the queued runs in their order."""

    def waiting() -> list[str]:
        with services.sessions.read() as session:
            order = places(session)
            found = session.scalars(select(order.c.id).order_by(order.c.place))
            return [str(run_id) for run_id in found]

    return waiting


@pytest.fixture
def reason(api) -> Callable[[str], str | None]:
    """Returns why a run waits."""
    return lambda run: api.get(f"runs/{run}").json()["waiting_reason"]


@pytest.fixture
def alive(services) -> Callable[..., None]:
    """Reports a live worker."""

    def alive(name="worker", status="idle", run=None, memory=1 << 40, **more: Any) -> None:
        registry.report(services.sessions, name, "some device", memory, status, run, **more)

    return alive


@pytest.fixture
def taken(services, alive) -> Callable[..., str | None]:
    """Reports a live worker, which takes its next run; returns the run's id."""

    def taken(name="worker", **more: Any) -> str | None:
        alive(name, **more)
        run_id = take(services, name)
        return run_id and str(run_id)

    return taken
