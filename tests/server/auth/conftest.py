"""Fixtures of tokens."""

import pytest

from microcosmos_server.auth import tokens
from microcosmos_server.tables import Token


@pytest.fixture
def admin(services) -> str:
    return tokens.create(services, "root", "admin").secret


@pytest.fixture
def rows(services):
    def read():
        with services.sessions.read() as session:
            return session.query(Token).all()

    return read
