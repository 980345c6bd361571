"""The table of shares."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import CheckConstraint, ForeignKey, Index, String, Text, select
from sqlalchemy.orm import Mapped, column_property, mapped_column

from ..core.database import clock
from .base import Base, Expiring, Owned, Sha256
from .creatures import Creature


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
    trusted: Mapped[bool | None] = column_property(
        select(Creature.trusted).where(Creature.sha256 == creature).scalar_subquery()
    )
    """The verdict of the shared creature's audit; null for an archive, or without an audit."""
