"""Tables of results: curves, rows of tables, elites, and creatures with their lineage."""

from datetime import datetime
from typing import Annotated, Any
from uuid import UUID

from sqlalchemy import BigInteger, ForeignKey, Index, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Sha256

RunKey = Annotated[
    UUID, mapped_column(ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True)
]
Place = Annotated[int, mapped_column(primary_key=True, autoincrement=False)]
"""Types of columns: the run of a row, and the number of a row within it."""


class Generation(Base):
    """One narrow row per generation: the curves."""

    __tablename__ = "generations"

    run_id: Mapped[RunKey]
    generation: Mapped[Place]
    qd_score: Mapped[float | None]
    coverage: Mapped[float | None]
    best: Mapped[float | None]
    mean: Mapped[float | None]
    evaluations: Mapped[int] = mapped_column(BigInteger)
    diverged: Mapped[int] = mapped_column(BigInteger)
    seconds: Mapped[float]
    summary: Mapped[dict[str, Any] | None]
    """As the run's, if this generation changed it."""


class Result(Base):
    """A row of the table that is a run's result; append-only."""

    __tablename__ = "results"

    run_id: Mapped[RunKey]
    number: Mapped[Place]
    """Its place in the whole table, from 0."""
    generation: Mapped[int]
    values: Mapped[dict[str, Any]]
    creature: Mapped[str | None] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), index=True
    )


class Elite(Base):
    """A new elite of a cell; append-only. The last row of a cell is its present elite."""

    __tablename__ = "elites"

    run_id: Mapped[RunKey]
    cell: Mapped[Place]
    generation: Mapped[Place]
    fitness: Mapped[float]
    descriptors: Mapped[list[float]]
    """In raw units, in the order of the archive's axes."""
    creature: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"), index=True)


class Creature(Base):
    """A creature. It stays after another one has taken its cell."""

    __tablename__ = "creatures"

    sha256: Mapped[str] = mapped_column(Sha256, primary_key=True)
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
    """An imported creature stays without any run."""


class Parent(Base):
    """One parent of a creature; narrow, so that children are found as fast as parents."""

    __tablename__ = "parents"
    __table_args__ = (Index(None, "parent"),)

    child: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"), primary_key=True)
    position: Mapped[Place]
    parent: Mapped[str] = mapped_column(Sha256)
    """Only elites are kept as creatures, so the parent may have no row."""


class InitialCreature(Base):
    """A creature that a run starts from, by its spec."""

    __tablename__ = "initial_creatures"

    run_id: Mapped[RunKey]
    creature: Mapped[str] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), primary_key=True, index=True
    )


class GarbageCreature(Base):
    """A creature to delete once its run is gone, unless something else uses it."""

    __tablename__ = "garbage_creatures"

    run_id: Mapped[UUID] = mapped_column(primary_key=True)
    creature: Mapped[str] = mapped_column(Sha256, primary_key=True)
