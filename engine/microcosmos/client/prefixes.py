"""Things named by the beginning of their ids, as people write them."""

from collections.abc import Iterable
from typing import Any
from uuid import UUID

from .connection import Connection
from .errors import NotFound, Refused


def only(
    connection: Connection,
    noun: str,
    begins: str,
    like: Iterable[dict[str, Any]],
    fetch: bool = True,
) -> dict[str, Any]:
    """The one entry whose id begins so; a whole id is asked for as it is."""
    begins = begins.strip().lower()
    if fetch and (whole := _whole(begins)):
        return connection.read(f"{noun}/{whole}")
    if not begins or set(begins) - set("0123456789abcdef-"):
        raise Refused(f"An id, or the beginning of one, is needed; got {begins!r}.")
    found = [one for one in like if one["id"].startswith(begins)]
    if not found:
        raise NotFound(
            f"No {noun[:-1]} at {connection.url} has an id that begins with {begins}."
        )
    if len(found) > 1:
        among = ", ".join(sorted(one["id"] for one in found[:8]))
        raise Refused(
            f"{begins} is the beginning of {len(found)} ids: {among}. Write more of it."
        )
    return found[0]


def _whole(text: str) -> str | None:
    try:
        return str(UUID(text))
    except ValueError:
        return None
