"""What happened to runs."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base


class LogEntry(Base):
    """A line of a run's journal; append-only but for entries that come again and again."""

    __tablename__ = "log_entries"
    __table_args__ = (Index(None, "run_id", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    run_id: Mapped[UUID] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    at: Mapped[datetime] = mapped_column(default=clock())
    level: Mapped[str] = mapped_column(String(16))
    attempt: Mapped[int]
    kind: Mapped[str | None] = mapped_column(String(16))
    """What it is one of, where there may be many."""
    text: Mapped[str] = mapped_column(Text)
