"""Tables of creatures, and of what concerns them: results, elites, files and shares."""

from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import (
    BigInteger,
    CheckConstraint,
    ForeignKey,
    Index,
    LargeBinary,
    String,
    Text,
    UniqueConstraint,
    select,
)
from sqlalchemy.orm import Mapped, column_property, mapped_column

from ..core.database import clock
from .base import Base, Expiring, Owned, Place, RunKey, Sha256


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
    # Deferred: a stream has about 7 kB (docs/operation.md), which lists would read in vain.
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


class Generation(Base):
    """A point of a run's curves."""

    __tablename__ = "generations"

    run_id: Mapped[RunKey]
    generation: Mapped[Place]
    qd_score: Mapped[float | None]
    coverage: Mapped[float | None]
    best: Mapped[float | None]
    mean: Mapped[float | None]
    evaluations: Mapped[int] = mapped_column(BigInteger)
    infeasible: Mapped[int] = mapped_column(BigInteger)
    seconds: Mapped[float]
    summary: Mapped[dict[str, Any] | None]
    """The summary of the run as of this generation; None if it did not change."""


class Result(Base):
    """A row of the table that is a run's result; append-only."""

    __tablename__ = "results"

    run_id: Mapped[RunKey]
    number: Mapped[Place]
    """The place in the whole table, from 0."""
    generation: Mapped[int]
    values: Mapped[dict[str, Any]]
    creature: Mapped[str | None] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), index=True
    )


class Elite(Base):
    """A new elite of a cell, or its loss; append-only. The last row of a cell is its present
    state.

    A cell that loses its elite without a new one has a row without a creature. An archive with
    a container has numbered places instead of cells.
    """

    __tablename__ = "elites"
    __table_args__ = (Index(None, "run_id", "fitness", "cell"),)

    run_id: Mapped[RunKey]
    cell: Mapped[Place]
    generation: Mapped[Place]
    fitness: Mapped[float | None]
    descriptors: Mapped[list[float] | None]
    """In raw units, in the order of the archive's axes."""
    creature: Mapped[str | None] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), index=True
    )


CHECKPOINT, SEGMENT = "checkpoint", "segment"
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
    """Generation of a checkpoint; for a segment that of the first checkpoint that names it."""
    creature: Mapped[str | None] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(Sha256)
    whole_size: Mapped[int | None] = mapped_column(BigInteger)
    whole_sha256: Mapped[str | None] = mapped_column(Sha256)
    """SHA-256 of the file that a head and its segments form; None without segments."""
    created_at: Mapped[datetime] = mapped_column(default=clock())


class GarbageFile(Base):
    """A file that is to be deleted; a whole folder if the path ends with a slash."""

    __tablename__ = "garbage_files"

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
    due_at: Mapped[datetime] = mapped_column(default=clock())
    """When it may be deleted. If that fails, it is tried after all others."""


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
