"""JSON that people send."""

import pytest

from server.core.uploads import parse


@pytest.mark.parametrize("body", [b'"\\\\u0000"', '"\U0001f41f"'.encode(), b'"\\ud83d\\udc1f"'])
def test_text_that_only_looks_odd_is_taken(body):
    assert parse(body) in ("\\u0000", "\U0001f41f")
