"""Tables of operation: totals that never fall, and notifications to be sent."""

from datetime import datetime
from typing import Any
from uuid import UUID, uuid4

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base


class Total(Base):
    """Something that is counted for as long as the installation lives."""

    __tablename__ = "totals"

    name: Mapped[str] = mapped_column(String(32), primary_key=True)
    host: Mapped[str] = mapped_column(String(255), primary_key=True)
    """The machine on which it happened; empty for the server."""
    kind: Mapped[str] = mapped_column(String(32), primary_key=True)
    """What `name` is divided by; empty if by nothing."""
    value: Mapped[float]
    changed_at: Mapped[datetime] = mapped_column(default=clock())


class Notification(Base):
    """An event of a run that a webhook is to be told; deleted once it was told."""

    __tablename__ = "notifications"

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    """Repeats of an event have the same id."""
    run_id: Mapped[UUID]
    kind: Mapped[str] = mapped_column(String(32))
    data: Mapped[dict[str, Any]]
    created_at: Mapped[datetime] = mapped_column(default=clock())
    due_at: Mapped[datetime] = mapped_column(default=clock())
    tries: Mapped[int] = mapped_column(default=0)
