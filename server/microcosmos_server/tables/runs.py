"""Tables of runs and sweeps, their log, and idempotency keys."""

from datetime import datetime
from typing import Any, Literal
from uuid import UUID, uuid4

from sqlalchemy import (
    JSON,
    BigInteger,
    CheckConstraint,
    Double,
    ForeignKey,
    Index,
    Integer,
    String,
    Text,
    literal_column,
    text,
)
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Owned, Sha256

Status = Literal["queued", "running", "paused", "finished", "failed", "cancelled"]
QUEUED, RUNNING, PAUSED = "queued", "running", "paused"
FINISHED, FAILED, CANCELLED = "finished", "failed", "cancelled"
STATUSES = (QUEUED, RUNNING, PAUSED, FINISHED, FAILED, CANCELLED)
TERMINAL = (FINISHED, FAILED, CANCELLED)
PRIORITIES = LOW, NORMAL, HIGH, URGENT = "low", "normal", "high", "urgent"
Priority = Literal["low", "normal", "high", "urgent"]
"""`urgent` goes before the runs of all owners, the others order the runs of one owner."""


SORTED = (
    *("created_at", "started_at", "finished_at", "experiment"),
    *("evaluations", "qd_score", "coverage", "best"),
)
"""Columns by which the list of runs is ordered, besides the name and the next two."""
# Without parameters, since an index serves only the expression that it has.
_PLACES = " ".join(f"WHEN '{status}' THEN {place}" for place, status in enumerate(STATUSES))
STATUS_PLACE = literal_column(f"CASE status {_PLACES} END", Integer)
PROGRESS = literal_column(
    f"CASE WHEN status = '{FINISHED}' THEN 1.0 "
    "ELSE CAST(generation AS DOUBLE PRECISION) / generations END",
    Double,
)


class Run(Owned, Base):
    """The execution of a spec, with its authoritative state."""

    __tablename__ = "runs"
    __table_args__ = (
        CheckConstraint(f"status IN {STATUSES}", name="status"),
        CheckConstraint(
            f"requested_state IN {(PAUSED, CANCELLED, QUEUED)}", name="requested_state"
        ),
        CheckConstraint(f"priority IN {PRIORITIES}", name="priority"),
        # One index for each order of the list: a page must need no sort
        # (tests/server/core/test_orders.py).
        *(Index(None, name, "id") for name in SORTED),
        Index("ix_runs_name_id", text("(lower(name))"), "id"),
        Index("ix_runs_status_id", text(f"({STATUS_PLACE})"), "id"),
        Index("ix_runs_progress_id", text(f"({PROGRESS})"), "id"),
        Index(None, "status", "heartbeat_at"),
        Index(None, "sweep", "sweep_index"),
        Index(None, "purge_at"),
    )

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    experiment: Mapped[str] = mapped_column(String(64))
    spec: Mapped[dict[str, Any]]
    plugin_versions: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))
    """Versions of plug-ins that its worker must have."""
    version: Mapped[str] = mapped_column(String(64))
    demonstration: Mapped[bool] = mapped_column(default=False)
    name: Mapped[str | None] = mapped_column(String(200))
    """Name, tags and note are for people alone."""
    tags: Mapped[list[str]] = mapped_column(default=list)
    note: Mapped[str | None] = mapped_column(Text)
    status: Mapped[str] = mapped_column(String(16), default=QUEUED)
    requested_state: Mapped[str | None] = mapped_column(String(16))
    """The state that a person wants; `queued`: the run yields to an urgent one."""
    requested_at: Mapped[datetime | None]
    cancelled_from: Mapped[str | None] = mapped_column(String(16))
    """What a cancelled run was before, `queued` or `paused`; None if a worker had it.

    Also `paused` if the cancellation replaced a requested pause.
    """
    created_at: Mapped[datetime] = mapped_column(default=clock())
    queued_at: Mapped[datetime] = mapped_column(default=clock())
    """When it last entered the queue, which decides its position there."""
    interrupted: Mapped[bool] = mapped_column(default=False)
    """The worker stopped or died: the run goes before all that wait, until a worker has it."""
    priority: Mapped[Priority] = mapped_column(String(16), default=NORMAL)
    labels: Mapped[list[str]] = mapped_column(default=list)
    """Labels that its worker must have."""
    memory_bytes: Mapped[int | None] = mapped_column(BigInteger)
    """Memory that its worker must have."""
    may_yield: Mapped[bool] = mapped_column(default=False)
    """The run returns to the queue if an urgent run finds no free worker."""
    device_patience: Mapped[float | None]
    """Seconds to wait for the kind of device that has computed the run so far, before another
    kind may continue it. None: wait for ever."""
    released_at: Mapped[datetime | None]
    """When its last attempt ended, or its cancellation was taken back."""
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]
    attempt: Mapped[int] = mapped_column(default=0)
    """Number of the current attempt; writes of other attempts are refused."""
    attempts_without_checkpoint: Mapped[int] = mapped_column(default=0)
    worker: Mapped[str | None] = mapped_column(String(255))
    """The worker that has the run. If the run is queued, the worker is about to claim it."""
    avoided_worker: Mapped[str | None] = mapped_column(String(255))
    """The worker of an attempt that failed: others go first."""
    device: Mapped[str | None] = mapped_column(Text)
    """The kind of device that has computed it so far."""
    sinks: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))
    """Sinks that also get its curves and files, such as `tensorboard:FOLDER`."""
    heartbeat_at: Mapped[datetime | None]
    generations: Mapped[int]
    """Number of generations at the end."""
    generation: Mapped[int] = mapped_column(default=0)
    """The last recorded one."""
    begun_generation: Mapped[int] = mapped_column(default=0)
    """The last generation that a worker began; later choices count from the next one."""
    checkpoint_generation: Mapped[int] = mapped_column(default=0)
    """The generation of the last checkpoint; 0 without a checkpoint."""
    rewinds: Mapped[int] = mapped_column(default=0)
    """Counts returns to a checkpoint: an archive as of a generation may differ after each."""
    evaluations: Mapped[int] = mapped_column(BigInteger, default=0)
    infeasible: Mapped[int] = mapped_column(BigInteger, default=0)
    seconds: Mapped[float] = mapped_column(default=0.0)
    """Wall time of the computing that led to the last recorded generation."""
    qd_score: Mapped[float | None]
    coverage: Mapped[float | None]
    best: Mapped[float | None]
    corrected_qd_score: Mapped[float | None]
    """From the last reevaluation of the elites, as are the next two; None without one."""
    corrected_coverage: Mapped[float | None]
    hit_rate: Mapped[float | None]
    summary: Mapped[dict[str, Any] | None]
    """Figures of the whole result, if it is a table."""
    error: Mapped[str | None] = mapped_column(Text)
    """The cause of its last failed attempt: a sentence, without a traceback."""
    error_details: Mapped[str | None] = mapped_column(Text)
    """The traceback, or the last lines that the process wrote."""
    warning: Mapped[str | None] = mapped_column(Text)
    sweep: Mapped[UUID | None]
    sweep_index: Mapped[int | None]
    """The place in the sweep, from 0: all cases with the first seed, then with the next."""
    deleted_at: Mapped[datetime | None]
    purge_at: Mapped[datetime | None]
    """When it is deleted for good; it can be restored until then."""
    n_initial: Mapped[int | None]
    """The number of creatures that a fork took from another run."""
    forked_from: Mapped[UUID | None]
    """The other run, while it exists."""


class Sweep(Owned, Base):
    """Runs that one request created: seeds, and a grid over fields of a spec."""

    __tablename__ = "sweeps"
    __table_args__ = (Index(None, "created_at", "id"),)

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    experiment: Mapped[str] = mapped_column(String(64))
    name: Mapped[str | None] = mapped_column(String(200))
    spec: Mapped[dict[str, Any]]
    """The spec of all runs, before the grid's values and the seed replace its own."""
    seeds: Mapped[list[int]]
    """Empty if the experiment has no seed."""
    grid: Mapped[dict[str, Any]]
    """Values by the dotted path of a field, in the order of the request."""
    created_at: Mapped[datetime] = mapped_column(default=clock())


class Idempotency(Base):
    """A client's key, so that the same request twice creates one run or one sweep."""

    __tablename__ = "idempotency"

    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    body_sha256: Mapped[str] = mapped_column(Sha256)
    run_id: Mapped[UUID | None] = mapped_column(ForeignKey("runs.id", ondelete="SET NULL"))
    """None for a sweep, and for a run that was deleted."""
    sweep: Mapped[UUID | None] = mapped_column(ForeignKey("sweeps.id", ondelete="SET NULL"))
    created_at: Mapped[datetime] = mapped_column(default=clock())


class LogEntry(Base):
    """A line of a run's log; append-only, except for frequent kinds."""

    __tablename__ = "log_entries"
    __table_args__ = (Index(None, "run_id", "id"),)

    id: Mapped[int] = mapped_column(primary_key=True)
    run_id: Mapped[UUID] = mapped_column(ForeignKey("runs.id", ondelete="CASCADE"))
    at: Mapped[datetime] = mapped_column(default=clock())
    level: Mapped[str] = mapped_column(String(16))
    attempt: Mapped[int]
    kind: Mapped[str | None] = mapped_column(String(16))
    """Set for frequent entries: an attempt keeps only the first and the last of a kind."""
    text: Mapped[str] = mapped_column(Text)
    details: Mapped[str | None] = mapped_column(Text)
    """The traceback, or the last lines of a process, behind an error."""
