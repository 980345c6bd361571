"""Paging: a cursor names the order, the key and the id of the last row that was sent."""

from base64 import urlsafe_b64decode, urlsafe_b64encode
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Annotated, Any

from pydantic import Field, FiniteFloat, StringConstraints, TypeAdapter
from pydantic_core import to_json
from sqlalchemy import ColumnElement, Select, Text, cast, func, literal, tuple_
from sqlalchemy.orm import Session

from .errors import invalid_field
from .schemas import Moment

MOMENT = Moment
TEXT = Annotated[str, StringConstraints(pattern=r"^[^\x00]*$")]
COUNT = Annotated[int, Field(ge=0, lt=1 << 63)]
NUMBER = FiniteFloat
"""Types of keys, with the values that every database can compare."""


PAGE_LENGTH = 8_000_000
"""Length of rows, in characters, after which a page ends: a spec may have 1 MB."""


def length(json: Any) -> ColumnElement[int]:
    """Return the length of a JSON column as text."""
    return func.length(cast(json, Text))


@dataclass(frozen=True)
class Order:
    """An order of rows by a key, then by id; rows without a key come last.

    An index of key and id serves it in both directions. `name` identifies the order in cursors;
    with a minus it is descending.
    """

    name: str
    key: ColumnElement[Any]
    key_type: Any
    id: Any
    id_type: Any
    length: ColumnElement[int] = field(default_factory=lambda: literal(0))
    """The length of a row. A page ends early where rows are long."""

    # Rows without a key are read apart: NULL is first in SQLite and last in PostgreSQL, and
    # `NULLS LAST` would need a sort in place of the index (tests/server/core/test_orders.py).
    def page(
        self, session: Session, statement: Select[Any], cursor: str | None, limit: int
    ) -> tuple[list[Any], str | None]:
        """Return the rows after a cursor, and the cursor of the next page, if there is one."""
        after = self._position(cursor) if cursor else None
        places: list[Any] = []
        if after is None or after[0] is not None:
            beyond = [] if after is None else [self._beyond(*after)]
            places += self._read(session, statement, limit + 1, self.key.is_not(None), *beyond)
        if len(places) <= limit:
            later = after and after[0] is None
            beyond = [self._beyond_id(after[1])] if after and later else []
            left = limit + 1 - len(places)
            places += self._read(session, statement, left, self.key.is_(None), *beyond)
        lengths = accumulate(length for *_, length in places[:limit])
        kept = max(1, sum(length <= PAGE_LENGTH for length in lengths))
        chosen = [identity for _, identity, _ in places[:kept]]
        rows = session.scalars(statement.where(self.id.in_(chosen)))
        found = {getattr(row, self.id.key): row for row in rows}
        # A row may have been deleted since its place was read.
        items = [found[identity] for identity in chosen if identity in found]
        if len(places) <= kept:
            return items, None
        last = [self.name, *places[kept - 1][:2]]
        return items, urlsafe_b64encode(to_json(last)).decode()

    @property
    def _descending(self) -> bool:
        return self.name.startswith("-")

    def _read(
        self, session: Session, statement: Select[Any], limit: int, *where: ColumnElement[bool]
    ) -> list[Any]:
        """Return key, id and length of rows that all have a key, or all have none."""
        columns = (self.key, self.id)
        order = [one.desc() for one in columns] if self._descending else columns
        places = statement.with_only_columns(*columns, self.length).where(*where)
        return list(session.execute(places.order_by(*order).limit(limit)))

    def _position(self, cursor: str) -> tuple[Any, Any]:
        kind = TypeAdapter(tuple[str, self.key_type | None, self.id_type])  # pyright: ignore
        try:
            # Anybody may send a cursor: PostgreSQL raises for a value of another type, SQLite
            # finds nothing (tests/server/runs/test_listing.py).
            name, key, identity = kind.validate_json(urlsafe_b64decode(cursor), strict=True)
        except ValueError:
            name = key = identity = None
        if name != self.name:
            needed = "the `next` of an earlier answer to the same `sort`"
            raise invalid_field("cursor", needed, cursor) from None
        return key, identity

    def _beyond(self, key: Any, identity: Any) -> ColumnElement[bool]:
        """Return the condition for rows after one with a key."""
        # A comparison of rows uses the index of both columns (sqlite.org/rowvalue.html).
        place = tuple_(self.key, self.id)
        given = tuple_(literal(key, self.key.type), literal(identity, self.id.type))
        return place < given if self._descending else place > given

    def _beyond_id(self, identity: Any) -> ColumnElement[bool]:
        return self.id < identity if self._descending else self.id > identity
