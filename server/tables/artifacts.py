"""Tables of files, and the names of their kinds."""

from datetime import datetime
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Sha256

CHECKPOINT = "checkpoint"
REPLAY, AUDIT, STRIP, GIF, MP4 = "replay", "audit", "strip.png", "film.gif", "film.mp4"
PREVIEW, LOOP = "preview.png", "loop.mp4"
MEASUREMENT, EVALUATION = "measurement", "evaluation"
"""Renderings of a creature, by their names in the API."""
PUBLISHED = "published"
"""The archive file of a share."""


class Artifact(Base):
    """A completely written file; without a row, a file does not count."""

    __tablename__ = "artifacts"
    __table_args__ = (
        UniqueConstraint("run_id", "kind", "number"),
        UniqueConstraint("creature", "kind"),
    )

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
    kind: Mapped[str] = mapped_column(String(16))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    number: Mapped[int | None]
    """Counts the checkpoints of a run; for a replay the version of its format."""
    generation: Mapped[int | None]
    creature: Mapped[str | None] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(Sha256)
    created_at: Mapped[datetime] = mapped_column(default=clock())


class GarbageFile(Base):
    """A file that is to be deleted; a whole folder if the path ends with a slash."""

    __tablename__ = "garbage_files"

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
