"""Read shares of any installation by their address: a verified creature, the spec of a run."""

import re
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from ..archive import pedigree
from .connection import Connection
from .errors import ServerError

ADDRESS = re.compile(
    r"(?P<server>https?://[^\s?#]+?)/s/(?P<slug>[A-Za-z0-9_-]{1,43})"
    r"(/creatures/(?P<creature>[0-9a-f]{64}))?/?"
)
SHARE_HEADER = "Microcosmos-Share"


class Address(NamedTuple):
    """A share on a server, and a creature in it."""

    server: str
    slug: str
    creature: str | None

    def read(self, path: str, headers: Mapping[str, str] | None = None, **params: Any) -> Any:
        """Read from its server, which gets no token: another installation owns it."""
        connection = Connection(self.server)
        try:
            return connection.json(connection.ask("GET", path, headers=headers, params=params))
        finally:
            connection.close()


def address(text: str) -> Address | None:
    """Return the parts of a share's address; None for any other text."""
    found = ADDRESS.fullmatch(text.strip())
    return Address(**found.groupdict()) if found else None


def creature(at: Address, *, with_ancestors: bool = True) -> dict[str, Any]:
    """Return the file of the shared creature, or of the best of an archive, with its ancestors.

    Each is verified by its hash. Raise `ServerError` or `CreatureError`.
    """
    wanted = {"creature": at.creature, "ancestors": with_ancestors}
    document = at.read(f"shares/{at.slug}/creature.json", **wanted)
    file, ancestors = pedigree.split(document)
    if at.creature not in (None, file["sha256"]):
        raise ServerError(f"{at.server} sent {file['sha256']} instead of {at.creature}.")
    return pedigree.document(file, ancestors)


def creatures(at: Address) -> Iterator[dict[str, Any]]:
    """Yield the files of all creatures of a share, the best first, without their ancestors.

    Raises as `creature` does.
    """
    named = [at.creature] if at.creature else None
    for name in named or at.read(f"shares/{at.slug}/creatures.json")["creatures"]:
        yield creature(at._replace(creature=name), with_ancestors=False)


def spec(at: Address) -> dict[str, Any]:
    """Return the spec of the run whose archive is shared."""
    run = at.read(f"shares/{at.slug}")["run"]
    if run is None:
        raise ValueError(
            f"a spec needs the share of an archive; {at.slug} shares a creature: import it"
        )
    return at.read(f"runs/{run}", {SHARE_HEADER: at.slug})["spec"]
