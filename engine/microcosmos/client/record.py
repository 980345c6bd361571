"""The base of runs and sweeps: a record on the server, and actions on it."""

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Generic, Self, TypeVar
from uuid import UUID

from .connection import Connection
from .errors import Kinds, NotFound, Refused, record

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
    KINDS: ClassVar[Kinds]
    id = Field[str]()
    name = Field[str | None]()

    def __init__(self, connection: Connection, document: Mapping[str, Any]):
        self._connection = connection
        self.record: dict[str, Any] = self._checked(document)
        """All fields that the server has."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and other.id == self.id

    def __hash__(self) -> int:
        return hash(self.id)

    def refresh(self) -> Self:
        self.record = self._checked(self._connection.read(self._path))
        return self

    def pause(self) -> Self:
        return self._ask("pause")

    def resume(self) -> Self:
        return self._ask("resume")

    def cancel(self) -> Self:
        """End it now, with what it has found; `uncancel` takes that back."""
        return self._ask("cancel")

    def uncancel(self) -> Self:
        """Take its cancellation back: it goes on from its last checkpoint."""
        return self._ask("uncancel")

    def restore(self) -> Self:
        """Bring it back from the bin."""
        return self._ask("restore")

    @property
    def _path(self) -> str:
        return f"{self.NOUN}/{self.id}"

    def _ask(self, action: str, document: Any = None) -> Self:
        made = self._connection.send("POST", f"{self._path}/{action}", document)
        self.record = self._checked(made)
        return self

    def _checked(self, document: Mapping[str, Any]) -> dict[str, Any]:
        return record(document, self._connection.url, self.KINDS)


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
    if not isinstance(id, str):
        raise Refused(f"An id, or the beginning of one, is needed as a text; got {id!r}.")
    id = id.strip().lower()
    # A whole id needs no list, which may have many pages.
    if fetch and (whole := _whole(id)):
        return connection.read(f"{noun}/{whole}")
    if not id or set(id) - set("0123456789abcdef-"):
        raise Refused(f"An id, or the beginning of one, is needed; got {id!r}.")
    known = (record(one, connection.url, {"id": (str,)}) for one in candidates)
    matching = [one for one in known if one["id"].startswith(id)]
    if not matching:
        raise NotFound(f"No {noun[:-1]} at {connection.url} has an id that begins with {id}.")
    if len(matching) > 1:
        among = ", ".join(sorted(one["id"] for one in matching[:8]))
        raise Refused(
            f"{id} is the beginning of {len(matching)} ids: {among}. Write more of it."
        )
    return matching[0]


def _whole(text: str) -> str | None:
    try:
        return str(UUID(text))
    except ValueError:
        return None
