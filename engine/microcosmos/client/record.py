"""The base of runs and sweeps: a record on the server, and actions on it."""

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Generic, Self, TypeVar
from uuid import UUID

from .connection import Connection
from .errors import NotFound, Refused, record

T = TypeVar("T")


class Field(Generic[T]):
    """An attribute that reads the field of its name in `record`."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, thing: Any, owner: type) -> T:
        return thing.record[self.name]


class Record:
    """A copy of the server's record; `refresh` reads it again."""

    NOUN: ClassVar[str]
    """Name of the kind in the API."""
    id = Field[str]()
    name = Field[str | None]()

    def __init__(self, connection: Connection, document: Mapping[str, Any]):
        self._connection = connection
        self.record: dict[str, Any] = record(document, connection.url)
        """All fields that the server has."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and other.id == self.id

    def __hash__(self) -> int:
        return hash(self.id)

    def refresh(self) -> Self:
        self.record = record(self._connection.read(self._path), self._connection.url)
        return self

    def pause(self) -> Self:
        return self._ask("pause")

    def resume(self) -> Self:
        return self._ask("resume")

    def cancel(self) -> Self:
        return self._ask("cancel")

    def restore(self) -> Self:
        """Bring it back from the bin."""
        return self._ask("restore")

    @property
    def _path(self) -> str:
        return f"{self.NOUN}/{self.id}"

    def _ask(self, action: str, document: Any = None) -> Self:
        self.record = self._connection.send("POST", f"{self._path}/{action}", document)
        return self


def find(
    connection: Connection,
    noun: str,
    id: str,
    candidates: Iterable[dict[str, Any]],
    fetch: bool = True,
) -> dict[str, Any]:
    """Return the only candidate whose id begins with `id`; `fetch` a whole id directly.

    Raise `NotFound`, and `Refused` for several.
    """
    id = id.strip().lower()
    if fetch and (whole := _whole(id)):
        return connection.read(f"{noun}/{whole}")
    if not id or set(id) - set("0123456789abcdef-"):
        raise Refused(f"An id, or the beginning of one, is needed; got {id!r}.")
    found = [one for one in candidates if one["id"].startswith(id)]
    if not found:
        raise NotFound(f"No {noun[:-1]} at {connection.url} has an id that begins with {id}.")
    if len(found) > 1:
        among = ", ".join(sorted(one["id"] for one in found[:8]))
        raise Refused(f"{id} is the beginning of {len(found)} ids: {among}. Write more of it.")
    return found[0]


def _whole(text: str) -> str | None:
    try:
        return str(UUID(text))
    except ValueError:
        return None
