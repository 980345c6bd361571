"""Tables of creatures, their parents, and the runs that start or descend from them."""

from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import ForeignKey, Index, LargeBinary, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Place, RunKey, Sha256


class Creature(Base):
    """A creature. Its row stays when another creature replaces it in its cell."""

    __tablename__ = "creatures"

    sha256: Mapped[str] = mapped_column(Sha256, primary_key=True)
    trusted: Mapped[bool | None]
    """The verdict of the saved audit; null without one. It precedes the large columns, which
    SQLite would otherwise read first."""
    identity: Mapped[bytes]
    """The canonical bytes, whose hash is the name."""
    parents: Mapped[list[str]]
    operator: Mapped[str | None] = mapped_column(Text)
    measured: Mapped[dict[str, Any] | None]
    provenance: Mapped[dict[str, Any] | None]
    """Generation, seed, version, without the parents and the operator."""
    licence: Mapped[str] = mapped_column(Text)
    credit: Mapped[list[str]] = mapped_column(default=list)
    """People to name wherever the creature is shown."""
    created_at: Mapped[datetime] = mapped_column(default=clock())
    imported: Mapped[bool] = mapped_column(default=False)
    """Imported creatures are never deleted, even if no run uses them."""
    poses: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    """The pose stream, if an evaluation recorded one."""


class Parent(Base):
    """A parent of a creature; indexed both ways, so that children are found as fast."""

    __tablename__ = "parents"
    __table_args__ = (Index(None, "parent"),)

    child: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"), primary_key=True)
    position: Mapped[Place]
    parent: Mapped[str] = mapped_column(Sha256)
    """The parent has no row in `creatures` if it was neither an elite nor imported."""


class InitialCreature(Base):
    """A creature that a run starts from, by its spec."""

    __tablename__ = "initial_creatures"

    run_id: Mapped[RunKey]
    creature: Mapped[str] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), primary_key=True, index=True
    )


PENDING = 0
"""The generation of a choice that does not count yet."""


class Choice(Base):
    """A creature of a run that a person chose: later generations descend from it, too."""

    __tablename__ = "choices"

    run_id: Mapped[RunKey]
    generation: Mapped[Place]
    """The first generation that descends from it; `PENDING` until that begins."""
    creature: Mapped[str] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), primary_key=True, index=True
    )


class GarbageCreature(Base):
    """A creature to delete once its run is gone, unless something else uses it."""

    __tablename__ = "garbage_creatures"

    run_id: Mapped[UUID] = mapped_column(primary_key=True)
    creature: Mapped[str] = mapped_column(Sha256, primary_key=True)
