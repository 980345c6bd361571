"""Runs: what is to be computed, and how each stands."""

from datetime import datetime
from typing import Any, Literal
from uuid import UUID, uuid4

from sqlalchemy import JSON, BigInteger, CheckConstraint, Index, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Owned

Status = Literal["queued", "running", "paused", "finished", "failed", "cancelled"]
QUEUED, RUNNING, PAUSED = "queued", "running", "paused"
FINISHED, FAILED, CANCELLED = "finished", "failed", "cancelled"
STATUSES = (QUEUED, RUNNING, PAUSED, FINISHED, FAILED, CANCELLED)
TERMINAL = (FINISHED, FAILED, CANCELLED)
OVERRIDE_NEEDED, OVERRIDE_ALLOWED = "needed", "allowed"


class Run(Owned, Base):
    """One spec being carried out; the truth about its state."""

    __tablename__ = "runs"
    __table_args__ = (
        CheckConstraint(f"status IN {STATUSES}", name="status"),
        CheckConstraint(f"requested_state IN {(PAUSED, CANCELLED)}", name="requested_state"),
        Index(None, "created_at", "id"),
        Index(None, "status", "heartbeat_at"),
        Index(None, "sweep", "sweep_index"),
        Index(None, "purge_at"),
    )

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    experiment: Mapped[str] = mapped_column(String(64))
    spec: Mapped[dict[str, Any]]
    plugin_versions: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))
    """Versions of modules of users' own that a worker must have to carry it out."""
    version: Mapped[str] = mapped_column(String(64))
    demonstration: Mapped[bool] = mapped_column(default=False)
    name: Mapped[str | None] = mapped_column(String(200))
    """What people call it; this, the tags and the note decide nothing."""
    tags: Mapped[list[str]] = mapped_column(default=list)
    note: Mapped[str | None] = mapped_column(Text)
    status: Mapped[str] = mapped_column(String(16), default=QUEUED)
    requested_state: Mapped[str | None] = mapped_column(String(16))
    requested_at: Mapped[datetime | None]
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
    device_override: Mapped[str | None] = mapped_column(String(16))
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
    sweep_index: Mapped[int | None]
    """Its place in the sweep, from 0: every case with the first seed, then with the next."""
    deleted_at: Mapped[datetime | None]
    """Since when it lies in the bin."""
    purge_at: Mapped[datetime | None]
    """When it goes for good: until then it can be restored, from then on it cannot."""
    n_initial: Mapped[int | None]
    """How many creatures of another run it began from, where it is a fork."""
    forked_from: Mapped[UUID | None]
    """That run, while it is there."""
