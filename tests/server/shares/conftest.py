"""Requests of the holder of a share."""

import pytest

from server.auth.capability import HEADER


@pytest.fixture
def through(api):
    return lambda slug, path, **asked: api.get(path, headers={HEADER: slug}, **asked)
