"""The table of tokens."""

from datetime import date, datetime
from uuid import UUID, uuid4

from sqlalchemy import CheckConstraint, Index, String, text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Expiring, Sha256

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
    max_queued: Mapped[int | None]
    """Quotas of its owner's runs; None: without limit."""
    max_running: Mapped[int | None]
    device_hours: Mapped[float | None]
    """Hours of devices in `USE_DAYS` days."""


USE_DAYS = 30
"""Days over which device hours are counted."""


class DeviceUse(Base):
    """Seconds for which the runs of an owner had a device, by day."""

    __tablename__ = "device_use"

    owner: Mapped[UUID] = mapped_column(primary_key=True)
    """The id of a token; `NOBODY` for runs without an owner."""
    day: Mapped[date] = mapped_column(primary_key=True)
    seconds: Mapped[float]


NOBODY = UUID(int=0)
