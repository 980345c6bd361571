"""What was published."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import CheckConstraint, ForeignKey, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Owned, Sha256


class Share(Owned, Base):
    """What anybody may see who has its address, until it is revoked or expires."""

    __tablename__ = "shares"
    __table_args__ = (
        CheckConstraint("(creature IS NULL) <> (run_id IS NULL)", name="one_thing"),
        Index(None, "created_at", "slug"),
    )

    slug: Mapped[str] = mapped_column(String(43), primary_key=True)
    """Random: whoever was not told it does not find it."""
    creature: Mapped[str | None] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    generation: Mapped[int | None]
    """The last one of the run that is seen: what comes later was not shared."""
    cover: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    """Whose picture stands for it: the creature itself, or the archive's best."""
    title: Mapped[str] = mapped_column(Text)
    credit: Mapped[list[str]]
    licence: Mapped[str] = mapped_column(Text)
    listed: Mapped[bool]
    created_at: Mapped[datetime] = mapped_column(default=clock())
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]
