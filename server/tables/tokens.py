"""Tables of tokens and shares, which open the server to others until they expire."""

from datetime import datetime
from uuid import UUID, uuid4

from sqlalchemy import CheckConstraint, ForeignKey, Index, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Expiring, Owned, Sha256

SCOPES = ("read", "write", "admin")
"""Each scope includes those before it."""


class Token(Expiring, Base):
    """A token. The row holds the hash of the secret, never the secret."""

    __tablename__ = "tokens"
    __table_args__ = (
        CheckConstraint(f"scope IN {SCOPES}", name="scope"),
        Index(
            None,
            "name",
            unique=True,
            sqlite_where=text("revoked_at IS NULL"),
            postgresql_where=text("revoked_at IS NULL"),
        ),
    )

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    name: Mapped[str] = mapped_column(String(64))
    secret_sha256: Mapped[str] = mapped_column(Sha256, unique=True)
    prefix: Mapped[str] = mapped_column(String(16))
    """The first characters of the secret, by which its holder recognises it."""
    scope: Mapped[str] = mapped_column(String(16))
    created_at: Mapped[datetime] = mapped_column(default=clock())
    last_used_at: Mapped[datetime | None]


class Share(Owned, Expiring, Base):
    """A creature or an archive that everybody with the address may see."""

    __tablename__ = "shares"
    __table_args__ = (
        CheckConstraint("(creature IS NULL) <> (run_id IS NULL)", name="one_thing"),
        Index(None, "created_at", "slug"),
    )

    slug: Mapped[str] = mapped_column(String(43), primary_key=True)
    """Random, so that nobody finds it by trying."""
    creature: Mapped[str | None] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    generation: Mapped[int | None]
    """The last generation of the run that the share shows."""
    cover: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    """The creature on its picture: the shared one, or the best of the archive."""
    title: Mapped[str] = mapped_column(Text)
    credit: Mapped[list[str]]
    licence: Mapped[str] = mapped_column(Text)
    listed: Mapped[bool]
    created_at: Mapped[datetime] = mapped_column(default=clock())
