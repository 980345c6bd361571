"""What runs and sweeps have in common: a record on the server, and what they are told to do."""

from collections.abc import Mapping
from typing import Any, ClassVar, Self

from .connection import Connection


class Record:
    """As it was when the server was last asked; `refresh` asks again."""

    NOUN: ClassVar[str]
    """What the API calls them."""

    def __init__(self, connection: Connection, record: Mapping[str, Any]):
        self._connection = connection
        self.record = dict(record)
        """All that the server tells of it."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, type(self)) and other.id == self.id

    def __hash__(self) -> int:
        return hash(self.id)

    @property
    def id(self) -> str:
        return self.record["id"]

    @property
    def name(self) -> str | None:
        return self.record["name"]

    def refresh(self) -> Self:
        self.record = self._connection.read(self._path)
        return self

    def pause(self) -> Self:
        return self._ask("pause")

    def resume(self) -> Self:
        return self._ask("resume")

    def cancel(self) -> Self:
        return self._ask("cancel")

    @property
    def _path(self) -> str:
        return f"{self.NOUN}/{self.id}"

    def _ask(self, action: str, document: Any = None) -> Self:
        self.record = self._connection.send("POST", f"{self._path}/{action}", document)
        return self
