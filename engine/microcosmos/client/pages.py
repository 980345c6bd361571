"""Lists that a server gives page by page."""

from collections.abc import Iterator
from typing import Any

from .connection import Connection


def items(connection: Connection, path: str, **params: Any) -> Iterator[dict[str, Any]]:
    """All entries, each page asked for when it is needed."""
    cursor: str | None = None
    while True:
        page = connection.read(path, **params, cursor=cursor)
        if isinstance(page, list):
            yield from page
            return
        yield from page["items"]
        cursor = page.get("next")
        if not cursor:
            return
