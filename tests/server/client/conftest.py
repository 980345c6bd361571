"""A client of a real server; over SQLite alone, since it is the same to a client."""

from collections.abc import Iterator
from typing import Any

import pytest

from microcosmos.client import Client


@pytest.fixture
def database() -> str:
    return "sqlite"


@pytest.fixture
def client(address: str) -> Iterator[Client]:
    with Client(address, patience=10.0) as client:
        yield client


@pytest.fixture
def run(client: Client, run_id: Any) -> Any:
    """The queued run, as the client has it."""
    return client.run(str(run_id))
