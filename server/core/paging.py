"""Paging: a cursor names the order, the key and the id of the last row that was sent."""

from base64 import urlsafe_b64decode, urlsafe_b64encode
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated, Any

from pydantic import AfterValidator, Field, FiniteFloat, StringConstraints, TypeAdapter
from pydantic_core import to_json
from sqlalchemy import ColumnElement, Select, and_, or_
from sqlalchemy.orm import Session

from .errors import invalid_field

MOMENT = Annotated[datetime, AfterValidator(lambda at: at.astimezone(UTC))]
TEXT = Annotated[str, StringConstraints(pattern=r"^[^\x00]*$")]
COUNT = Annotated[int, Field(ge=0, lt=1 << 63)]
NUMBER = FiniteFloat
"""Types of keys, with the values that every database can compare."""


@dataclass(frozen=True)
class Order:
    """An order of rows by a key, then by id; rows without a key come last.

    `name` identifies the order in cursors; with a minus it is descending.
    """

    name: str
    key: ColumnElement[Any]
    key_type: Any
    id: Any
    id_type: Any

    def page(
        self, session: Session, statement: Select[Any], cursor: str | None, limit: int
    ) -> tuple[list[Any], str | None]:
        """Return the rows after a cursor, and the cursor of the next page, if there is one."""
        listed = statement.add_columns(self.key)
        if cursor:
            listed = listed.where(self._after(*self._position(cursor)))
        descending = self.name.startswith("-")
        columns = [column.desc() if descending else column for column in (self.key, self.id)]
        listed = listed.order_by(self.key.is_(None), *columns).limit(limit + 1)
        rows = session.execute(listed).all()
        items = [row for row, _ in rows[:limit]]
        if len(rows) <= limit:
            return items, None
        last = [self.name, rows[limit - 1][1], getattr(items[-1], self.id.key)]
        return items, urlsafe_b64encode(to_json(last)).decode()

    def _position(self, cursor: str) -> tuple[Any, Any]:
        kind = TypeAdapter(tuple[str, self.key_type | None, self.id_type])  # pyright: ignore
        try:
            name, key, identity = kind.validate_json(urlsafe_b64decode(cursor), strict=True)
        except (ValueError, OverflowError):
            name = key = identity = None
        if name != self.name:
            needed = "the `next` of an earlier answer to the same `sort`"
            raise invalid_field("cursor", needed, cursor) from None
        return key, identity

    def _after(self, key: Any, identity: Any) -> ColumnElement[bool]:
        descending = self.name.startswith("-")
        later = self.id < identity if descending else self.id > identity
        if key is None:
            return and_(self.key.is_(None), later)
        beyond = self.key < key if descending else self.key > key
        return or_(beyond, and_(self.key == key, later), self.key.is_(None))
