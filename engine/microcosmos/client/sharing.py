"""Shares: links under which others see a creature or an archive."""

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

from .connection import Connection
from .errors import record
from .record import Field


class Share:
    """A published link, valid until it expires or is revoked."""

    slug = Field[str]()

    def __init__(self, connection: Connection, document: Mapping[str, Any]):
        self._connection = connection
        self.record: dict[str, Any] = record(document, connection.url)
        """All fields that the server has."""

    @property
    def url(self) -> str:
        """Return the whole address; the server may omit its own."""
        url = str(self.record["url"])
        return url if "://" in url else f"{self._connection.url}/{url.lstrip('/')}"

    def __repr__(self) -> str:
        return f"<Share {self.url}>"

    def revoke(self) -> None:
        self._connection.send("DELETE", f"shares/{self.slug}")


def publish(
    connection: Connection,
    what: Mapping[str, Any],
    *,
    days: float | None = None,
    listed: bool = False,
    **texts: str | None,
) -> Share:
    """Share a creature or an archive; the link expires after `days`.

    `texts` are `title`, `credit` and `licence`. The commons show it if it is `listed`.
    """
    given = {**texts, "expires_at": None if days is None else expiry(days)}
    given = {name: value for name, value in given.items() if value is not None}
    found = connection.send("POST", "shares", {**what, **given, "listed": listed})
    return Share(connection, found)


def expiry(days: float) -> str:
    """Return the time `days` from now, as ISO 8601."""
    now = datetime.now(UTC)
    if not 0 < days <= (datetime.max.replace(tzinfo=UTC) - now).days:
        raise ValueError(f"`days` must be above 0 and end before the year 10000, got {days}")
    return (now + timedelta(days=days)).isoformat()
