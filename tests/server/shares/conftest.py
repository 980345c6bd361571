"""Fixtures of shares, and requests with a share's header."""

from typing import Any

import pytest

from microcosmos_server.auth.authorize import SHARE_HEADER


@pytest.fixture
def file(file) -> dict[str, Any]:
    """A creature file with a credit."""
    return {**file, "credit": ["Ada"]}


@pytest.fixture
def through(api):
    return lambda slug, path, **asked: api.get(path, headers={SHARE_HEADER: slug}, **asked)
