"""Shares: links to creatures and archives; publish them, and read those of any server."""

import re
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime, timedelta
from typing import Any, NamedTuple

import numpy as np

from ..archive import pedigree
from ..invalid import InvalidField
from .connection import Connection
from .errors import RUN, Answer, Kinds, ServerError, record
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

    `texts` are the fields of `docs/sharing.md` that are texts, such as `title`, `credit` and
    `licence`. The commons show it if it is `listed`.
    """
    given = {**texts, "expires_at": None if days is None else expiry(days)}
    given = {name: value for name, value in given.items() if value is not None}
    record = connection.send("POST", "shares", {**what, **given, "listed": listed})
    return Share(connection, record)


def expiry(days: float) -> str:
    """Return the time `days` from now, as ISO 8601."""
    now = datetime.now(UTC)
    if isinstance(days, bool) or not isinstance(days, int | float | np.number):
        raise InvalidField("days", f"must be a number; got {days!r:.80}")
    if not 0 < days <= (datetime.max.replace(tzinfo=UTC) - now).days:
        raise ValueError(f"`days` must be above 0 and end before the year 10000, got {days}")
    return (now + timedelta(days=float(days))).isoformat()


ADDRESS = re.compile(
    r"(?P<server>https?://[^\s?#]+?)/s/(?P<slug>[A-Za-z0-9_-]{1,43})"
    r"(/creatures/(?P<creature>[0-9a-f]{64}))?/?"
)
SLUG = re.compile(r"[A-Za-z0-9_-]{1,43}")
SHARE_HEADER = "Microcosmos-Share"


class Address(NamedTuple):
    """A share on a server, and a creature in it."""

    server: str
    slug: str
    creature: str | None

    def read(
        self,
        path: str,
        kinds: Kinds | None = None,
        headers: Mapping[str, str] | None = None,
        **params: Any,
    ) -> Answer:
        """Read a record from its server, which gets no token: another installation owns it."""
        connection = Connection(self.server)
        try:
            answer = connection.ask("GET", path, headers=headers, params=params)
            return record(connection.json(answer), connection.url, kinds)
        finally:
            connection.close()


def address(text: str) -> Address | None:
    """Return the parts of a share's address; None for any other text."""
    match = ADDRESS.fullmatch(text.strip())
    return Address(**match.groupdict()) if match else None


def slug(text: str) -> str:
    """Return the slug of a share, given it or the whole address."""
    found = str(text).rstrip("/").rpartition("/")[2]
    if not SLUG.fullmatch(found):
        raise InvalidField("slug", f"must be that of a share, or its address; got {text!r:.80}")
    return found


def creature(at: Address, *, with_ancestors: bool = True) -> dict[str, Any]:
    """Return the file of the shared creature, or of the best of an archive, with its ancestors.

    Each is verified by its hash. Raise `ServerError` or `CreatureError`.
    """
    wanted = {"creature": at.creature, "ancestors": with_ancestors}
    document = at.read(f"shares/{at.slug}/creature.json", **wanted)
    file, ancestors = pedigree.split(document)
    # The other server is not trusted: it might send any creature under this address.
    if at.creature not in (None, file["sha256"]):
        raise ServerError(f"{at.server} sent {file['sha256']} instead of {at.creature}.")
    return pedigree.document(file, ancestors)


def creatures(at: Address) -> Iterator[dict[str, Any]]:
    """Yield the files of all creatures of a share, the best first, without their ancestors.

    Raises as `creature` does.
    """
    named = [at.creature] if at.creature else None
    path = f"shares/{at.slug}/creatures.json"
    for name in named or at.read(path, {"creatures": (list,)})["creatures"]:
        yield creature(at._replace(creature=name), with_ancestors=False)


def spec(at: Address) -> dict[str, Any]:
    """Return the spec of the run whose archive is shared."""
    run = at.read(f"shares/{at.slug}", {"run": (str, type(None))})["run"]
    if run is None:
        raise ValueError(
            f"a spec needs the share of an archive; {at.slug} shares a creature: import it"
        )
    return at.read(f"runs/{run}", RUN, {SHARE_HEADER: at.slug})["spec"]
