"""What runs that are gone leave to be cleared away."""

from uuid import UUID

from sqlalchemy import String
from sqlalchemy.orm import Mapped, mapped_column

from .base import Base, Sha256


class GarbageCreature(Base):
    """A creature that goes with a run that is gone, unless something else uses it."""

    __tablename__ = "garbage_creatures"

    run_id: Mapped[UUID] = mapped_column(primary_key=True)
    """Nothing happens while that run is there."""
    creature: Mapped[str] = mapped_column(Sha256, primary_key=True)


class GarbageFile(Base):
    """A file that nothing needs any more and that has still to be removed."""

    __tablename__ = "garbage_files"

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
    """Of a whole folder where it ends with a slash."""
