"""Base classes of the tables, and types of columns that several of them have."""

from datetime import datetime
from typing import Annotated, Any, ClassVar, TypeVar
from uuid import UUID

from sqlalchemy import (
    JSON,
    ColumnElement,
    Double,
    ForeignKey,
    LargeBinary,
    MetaData,
    and_,
    or_,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, Session, mapped_column
from sqlalchemy.types import TypeDecorator

from ..core.database import Moment, clock, now
from ..core.errors import NotFound, invalid_field


class Sha256(TypeDecorator[str]):
    """A hash: hexadecimal here, 32 bytes in the database."""

    impl = LargeBinary(32)
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Any) -> bytes | None:
        return bytes.fromhex(value) if value is not None else None

    def process_result_value(self, value: bytes | None, dialect: Any) -> str | None:
        return value.hex() if value is not None else None


class Base(DeclarativeBase):
    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "ck": "ck_%(table_name)s_%(constraint_name)s",
            "fk": "fk_%(table_name)s_%(column_0_N_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map: ClassVar = {
        datetime: Moment(),
        float: Double(),
        # Otherwise None would be stored as the JSON text `null`, which `IS NULL` does not find.
        dict[str, Any]: JSON(none_as_null=True),
        list[str]: JSON(),
        list[dict[str, Any]]: JSON(),
        list[float]: JSON(none_as_null=True),
        list[int]: JSON(),
    }


RunKey = Annotated[
    UUID, mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
]
Place = Annotated[int, mapped_column(primary_key=True, autoincrement=False)]
"""The number of a row within its run."""


class Owned:
    """A row with an owner: the token that created it, or None without a token."""

    owner: Mapped[UUID | None]
    """The id of a token. Tokens are never deleted, so a revoked one still has a name."""


class Expiring:
    """A row that is live until it expires or is revoked."""

    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]

    @classmethod
    def live(cls) -> ColumnElement[bool]:
        lasting = or_(cls.expires_at.is_(None), cls.expires_at > clock())
        return and_(cls.revoked_at.is_(None), lasting)

    def expired(self, session: Session) -> bool:
        return self.expires_at is not None and self.expires_at <= now(session)


T = TypeVar("T", bound=Base)


def find(session: Session, table: type[T], key: Any, named: str = "id") -> T:
    """Return a row; raise `NotFound` if it is missing."""
    row = session.get(table, key)
    if row is None:
        raise NotFound(f"No {table.__name__.lower()} has the {named} {key}.")
    return row


def refuse_past(session: Session, expires_at: datetime | None) -> None:
    if expires_at is not None and expires_at <= (current := now(session)):
        needed = f"a moment after now, {current:%Y-%m-%d %H:%M} UTC"
        raise invalid_field("expires_at", needed, expires_at.isoformat())
