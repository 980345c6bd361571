"""Links under which others see a creature or an archive."""

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import Any

from .connection import Connection


class Share:
    """A link that is published, until it expires or is revoked."""

    def __init__(self, connection: Connection, document: Mapping[str, Any]):
        self._connection = connection
        self.record = dict(document)
        """All that the server tells of it."""

    @property
    def slug(self) -> str:
        return self.record["slug"]

    @property
    def url(self) -> str:
        """The whole address, whichever way the server writes it."""
        url = str(self.record["url"])
        return url if "://" in url else f"{self._connection.url}/{url.lstrip('/')}"

    def __repr__(self) -> str:
        return f"<Share {self.url}>"

    def revoke(self) -> None:
        """From now on the link leads nowhere."""
        self._connection.send("DELETE", f"shares/{self.slug}")


def publish(
    connection: Connection,
    what: Mapping[str, Any],
    *,
    title: str | None = None,
    credit: str | None = None,
    licence: str | None = None,
    days: float | None = None,
    listed: bool = False,
) -> Share:
    """Share what a document names; after so many `days` the link expires.

    Only what is `listed` is found in the commons.
    """
    said = {"title": title, "credit": credit, "licence": licence, "expires_at": expiry(days)}
    said = {name: value for name, value in said.items() if value is not None}
    found = connection.send("POST", "shares", {**what, **said, "listed": listed})
    return Share(connection, found)


def expiry(days: float | None) -> str | None:
    """The moment so many days from now."""
    if days is None:
        return None
    if days <= 0:
        raise ValueError(f"`days` must be above 0, got {days}")
    return (datetime.now(UTC) + timedelta(days=days)).isoformat()
