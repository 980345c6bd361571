"""A client of a real server; over SQLite alone, since it is the same to a client."""

from collections.abc import Iterator
from typing import Any

import pytest
from relay import Relay

from microcosmos.client import Client, connection, files, polling


@pytest.fixture
def database() -> str:
    return "sqlite"


@pytest.fixture
def client(address: str) -> Iterator[Client]:
    with Client(address, patience=10.0) as client:
        yield client


@pytest.fixture
def run(client: Client, run_id: Any) -> Any:
    return client.run(str(run_id))


@pytest.fixture
def relay(address: str) -> Iterator[Relay]:
    relay = Relay(address)
    yield relay
    relay.close()


@pytest.fixture
def no_sleep(monkeypatch) -> list[float]:
    """Notes pauses instead of sleeping."""
    pauses: list[float] = []
    for module in (connection, files, polling):
        monkeypatch.setattr(module.time, "sleep", pauses.append)
    return pauses
