"""The tables. Rows are not wire types: those are in `schemas`."""

from datetime import datetime
from typing import Any, ClassVar
from uuid import UUID, uuid4

from sqlalchemy import (
    JSON,
    BigInteger,
    CheckConstraint,
    Double,
    ForeignKey,
    Index,
    LargeBinary,
    MetaData,
    String,
    Text,
    UniqueConstraint,
    text,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator

from .caller import RANKS, owner
from .db import Moment, clock

QUEUED, RUNNING, PAUSED = "queued", "running", "paused"
FINISHED, FAILED, CANCELLED = "finished", "failed", "cancelled"
STATUSES = (QUEUED, RUNNING, PAUSED, FINISHED, FAILED, CANCELLED)
TERMINAL = (FINISHED, FAILED, CANCELLED)
PAUSE, CANCEL = "pause", "cancel"
NEEDED, GIVEN = "needed", "given"
CHECKPOINT = "checkpoint"
REPLAY, AUDIT, STRIP, GIF, MP4 = "replay", "audit", "strip.png", "film.gif", "film.mp4"
PREVIEW, MEASUREMENT = "preview.png", "measurement"
"""What can be made of a creature, under the names that the API has for it."""
PUBLISHED = "published"
"""An archive file as it was when it was shared."""


class Sha256(TypeDecorator[str]):
    """A hash: hexadecimal here, 32 bytes in the database."""

    impl = LargeBinary(32)
    cache_ok = True

    def process_bind_param(self, value: str | None, dialect: Any) -> bytes | None:
        return bytes.fromhex(value) if value is not None else None

    def process_result_value(self, value: bytes | None, dialect: Any) -> str | None:
        return value.hex() if value is not None else None


class Base(DeclarativeBase):
    metadata = MetaData(
        naming_convention={
            "ix": "ix_%(table_name)s_%(column_0_N_name)s",
            "uq": "uq_%(table_name)s_%(column_0_N_name)s",
            "ck": "ck_%(table_name)s_%(constraint_name)s",
            "fk": "fk_%(table_name)s_%(column_0_N_name)s",
            "pk": "pk_%(table_name)s",
        }
    )
    type_annotation_map: ClassVar = {
        datetime: Moment(),
        float: Double(),
        dict[str, Any]: JSON(none_as_null=True),
        list[str]: JSON(),
        list[dict[str, Any]]: JSON(),
        list[float]: JSON(),
        list[int]: JSON(),
    }


class Token(Base):
    """Leave to use the server: of the secret only the hash, so that nobody can read it here."""

    __tablename__ = "tokens"
    __table_args__ = (
        CheckConstraint(f"scope IN {RANKS}", name="scope"),
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
    beginning: Mapped[str] = mapped_column(String(16))
    """The first characters of the secret, to tell which one it is."""
    scope: Mapped[str] = mapped_column(String(16))
    created_at: Mapped[datetime] = mapped_column(default=clock())
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]
    last_used_at: Mapped[datetime | None]


class Owned:
    """What belongs to whoever made it: the holder of a token, else nobody."""

    owner: Mapped[UUID | None] = mapped_column(default=owner)
    """A token, of which none is ever deleted: what is revoked still has a name."""


class Sweep(Owned, Base):
    """Runs that were asked for together: seeds, and a grid over fields of a spec."""

    __tablename__ = "sweeps"
    __table_args__ = (Index(None, "created_at", "id"),)

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    experiment: Mapped[str] = mapped_column(String(64))
    name: Mapped[str | None] = mapped_column(String(200))
    spec: Mapped[dict[str, Any]]
    """What all runs have in common, but for the grid's fields and the seed."""
    seeds: Mapped[list[int]]
    """None where the experiment has no seed."""
    grid: Mapped[dict[str, Any]]
    """Values by the dotted path of a field, in the order in which they were given."""
    created_at: Mapped[datetime] = mapped_column(default=clock())


class Run(Owned, Base):
    """One spec being carried out; the truth about its state."""

    __tablename__ = "runs"
    __table_args__ = (
        CheckConstraint(f"status IN {STATUSES}", name="status"),
        CheckConstraint(f"wish IN {(PAUSE, CANCEL)}", name="wish"),
        Index(None, "created_at", "id"),
        Index(None, "status", "heartbeat_at"),
        Index(None, "sweep", "place"),
        Index(None, "purge_at"),
    )

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    experiment: Mapped[str] = mapped_column(String(64))
    spec: Mapped[dict[str, Any]]
    sources: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))
    """Versions of modules of users' own that a worker must have to carry it out."""
    version: Mapped[str] = mapped_column(String(64))
    demonstration: Mapped[bool] = mapped_column(default=False)
    name: Mapped[str | None] = mapped_column(String(200))
    """What people call it; this, the tags and the note decide nothing."""
    tags: Mapped[list[str]] = mapped_column(default=list)
    note: Mapped[str | None] = mapped_column(Text)
    status: Mapped[str] = mapped_column(String(16), default=QUEUED)
    wish: Mapped[str | None] = mapped_column(String(16))
    wished_at: Mapped[datetime | None]
    created_at: Mapped[datetime] = mapped_column(default=clock())
    queued_at: Mapped[datetime] = mapped_column(default=clock())
    """Since when it waits, or when it last began to: its place in the queue."""
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]
    attempt: Mapped[int] = mapped_column(default=0)
    """The fence: whoever writes proves first that this is still their own."""
    attempts_without_checkpoint: Mapped[int] = mapped_column(default=0)
    worker: Mapped[str | None] = mapped_column(String(255))
    device: Mapped[str | None] = mapped_column(Text)
    device_leave: Mapped[str | None] = mapped_column(String(16))
    """Leave to go on on another kind of device than began it: None until it is `needed`."""
    heartbeat_at: Mapped[datetime | None]
    generations: Mapped[int]
    """How many there will be."""
    generation: Mapped[int] = mapped_column(default=0)
    """The last one recorded."""
    checkpoint_generation: Mapped[int] = mapped_column(default=0)
    """The one that the last checkpoint holds; 0 without a checkpoint."""
    evaluations: Mapped[int] = mapped_column(BigInteger, default=0)
    diverged: Mapped[int] = mapped_column(BigInteger, default=0)
    seconds: Mapped[float] = mapped_column(default=0.0)
    """Wall time of the computing that led to the last record."""
    qd_score: Mapped[float | None]
    coverage: Mapped[float | None]
    best: Mapped[float | None]
    summary: Mapped[dict[str, Any] | None]
    """Figures of the result as a whole, where it is a table."""
    error: Mapped[str | None] = mapped_column(Text)
    warning: Mapped[str | None] = mapped_column(Text)
    sweep: Mapped[UUID | None]
    place: Mapped[int | None]
    """Its place in the sweep, from 0: every case with the first seed, then with the next."""
    deleted_at: Mapped[datetime | None]
    """Since when it lies in the bin."""
    purge_at: Mapped[datetime | None]
    """When it goes for good: until then it can be restored, from then on it cannot."""
    forked: Mapped[int | None]
    """How many creatures of another run it began from, where it is a fork."""
    forked_from: Mapped[UUID | None]
    """That run, while it is there."""


class Generation(Base):
    """One narrow row per generation: the curves."""

    __tablename__ = "generations"

    run_id: Mapped[UUID] = mapped_column(
        ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
    )
    generation: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    qd_score: Mapped[float | None]
    coverage: Mapped[float | None]
    best: Mapped[float | None]
    mean: Mapped[float | None]
    evaluations: Mapped[int] = mapped_column(BigInteger)
    diverged: Mapped[int] = mapped_column(BigInteger)
    seconds: Mapped[float]
    summary: Mapped[dict[str, Any] | None]
    """As the run's, where this generation changed it."""


class Result(Base):
    """A row of the table that is a run's result; append-only."""

    __tablename__ = "results"

    run_id: Mapped[UUID] = mapped_column(
        ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
    )
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    """Its place in the whole table, from 0."""
    generation: Mapped[int]
    values: Mapped[dict[str, Any]]
    creature: Mapped[str | None] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), index=True
    )


class Elite(Base):
    """A cell's new elite; append-only. Now is the last row of a cell, the past one before."""

    __tablename__ = "elites"

    run_id: Mapped[UUID] = mapped_column(
        ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
    )
    cell: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    generation: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    fitness: Mapped[float]
    descriptors: Mapped[list[float]]
    """In raw units, in the order of the archive's axes."""
    creature: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"), index=True)


class Creature(Base):
    """A creature by its name; kept after its cell was taken by another."""

    __tablename__ = "creatures"

    sha256: Mapped[str] = mapped_column(Sha256, primary_key=True)
    identity: Mapped[bytes]
    """The canonical bytes, whose hash is the name."""
    parents: Mapped[list[str]]
    operator: Mapped[str | None] = mapped_column(Text)
    measured: Mapped[dict[str, Any] | None]
    provenance: Mapped[dict[str, Any] | None]
    """What else is known of its origin: generation, seed, version."""
    licence: Mapped[str] = mapped_column(Text)
    credit: Mapped[list[str]] = mapped_column(default=list)
    """Who is to be named wherever it is shown."""
    created_at: Mapped[datetime] = mapped_column(default=clock())
    imported: Mapped[bool] = mapped_column(default=False)
    """Whether somebody brought it, so that it stays without any run."""


class Origin(Base):
    """A creature that a run begins from, as its spec says."""

    __tablename__ = "origins"

    run_id: Mapped[UUID] = mapped_column(
        ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
    )
    creature: Mapped[str] = mapped_column(
        Sha256, ForeignKey("creatures.sha256"), primary_key=True, index=True
    )


class Leftover(Base):
    """A creature that goes with a run that is gone, unless something else uses it."""

    __tablename__ = "leftovers"

    run_id: Mapped[UUID] = mapped_column(primary_key=True)
    """Nothing happens while that run is there."""
    creature: Mapped[str] = mapped_column(Sha256, primary_key=True)


class Discarded(Base):
    """A file that nothing needs any more and that has still to be removed."""

    __tablename__ = "discarded"

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
    """Of a whole folder where it ends with a slash."""


class Parent(Base):
    """One parent of a creature; narrow, so that children are found as fast as parents."""

    __tablename__ = "parents"
    __table_args__ = (Index(None, "parent"),)

    child: Mapped[str] = mapped_column(Sha256, ForeignKey("creatures.sha256"), primary_key=True)
    place: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    parent: Mapped[str] = mapped_column(Sha256)
    """Its name; only who became an elite is kept as a creature."""


class Artifact(Base):
    """A file that is completely written; without a row, a file does not count."""

    __tablename__ = "artifacts"
    __table_args__ = (
        UniqueConstraint("run_id", "kind", "number"),
        UniqueConstraint("creature", "kind"),
    )

    path: Mapped[str] = mapped_column(String(255), primary_key=True)
    kind: Mapped[str] = mapped_column(String(16))
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    number: Mapped[int | None]
    """Counts the checkpoints of a run; of a replay the version of its format."""
    generation: Mapped[int | None]
    creature: Mapped[str | None] = mapped_column(Sha256, ForeignKey("creatures.sha256"))
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(Sha256)
    created_at: Mapped[datetime] = mapped_column(default=clock())


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


class Entry(Base):
    """A line of a run's journal; append-only but for entries that come again and again."""

    __tablename__ = "journal"
    __table_args__ = (Index(None, "run_id", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    run_id: Mapped[UUID] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    at: Mapped[datetime] = mapped_column(default=clock())
    level: Mapped[str] = mapped_column(String(16))
    attempt: Mapped[int]
    kind: Mapped[str | None] = mapped_column(String(16))
    """What it is one of, where there may be many."""
    text: Mapped[str] = mapped_column(Text)


class Worker(Base):
    """A worker as it last reported."""

    __tablename__ = "workers"

    name: Mapped[str] = mapped_column(String(255), primary_key=True)
    device: Mapped[str] = mapped_column(Text)
    kind: Mapped[str] = mapped_column(String(16))
    memory_bytes: Mapped[int] = mapped_column(BigInteger)
    memory_used_bytes: Mapped[int | None] = mapped_column(BigInteger)
    load: Mapped[float | None]
    """How busy the device is with anything at all: 1 is fully."""
    status: Mapped[str] = mapped_column(String(16))
    run_id: Mapped[UUID | None]
    since: Mapped[datetime] = mapped_column(default=clock())
    """When its status or its run last changed."""
    heartbeat_at: Mapped[datetime] = mapped_column(default=clock())
    plugins: Mapped[list[dict[str, Any]]] = mapped_column(default=list)
    """Declarations of what it has of users' own."""
    unloaded: Mapped[list[dict[str, Any]]] = mapped_column(default=list)
    """Modules that it could not load: `module` and `reason`."""


class Plugin(Base):
    """Something of users' own that a worker has, or had; a row for each version."""

    __tablename__ = "plugins"

    kind: Mapped[str] = mapped_column(String(16), primary_key=True)
    name: Mapped[str] = mapped_column(String(128), primary_key=True)
    source: Mapped[str] = mapped_column(Sha256, primary_key=True)
    declaration: Mapped[dict[str, Any]] = mapped_column(JSON())
    seen_at: Mapped[datetime] = mapped_column(default=clock())
    """When a worker first came with it, or came back."""


class Idempotency(Base):
    """A key that a client chose, so that asking twice gives one run, or one sweep."""

    __tablename__ = "idempotency"

    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    body_sha256: Mapped[str] = mapped_column(Sha256)
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    sweep: Mapped[UUID | None] = mapped_column(ForeignKey("sweeps.id", ondelete="CASCADE"))
    created_at: Mapped[datetime] = mapped_column(default=clock())
