"""Tables of the installation: state, totals, notifications, tokens, workers, plug-ins."""

from datetime import date, datetime
from typing import Any, Literal
from uuid import UUID, uuid4

from sqlalchemy import JSON, BigInteger, CheckConstraint, Index, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Expiring, Sha256


class InstallationState(Base):
    """The one row of the installation; the migration inserts it."""

    __tablename__ = "installation"

    id: Mapped[UUID] = mapped_column(primary_key=True)
    """Names this database and its store."""
    verdicts: Mapped[int] = mapped_column(default=0)
    """Counts changes of the verdicts of audits, which archives show."""
    reconciled_at: Mapped[datetime | None]
    """When a server last began the periodic work; another one waits for its turn."""
    passed_at: Mapped[datetime | None]
    """When a server last completed it."""
    seen_at: Mapped[datetime | None]
    """When a server last ended it, complete or not: the database was there."""
    reachable_since: Mapped[datetime | None]
    """Since when passes follow each other: before, the database or all servers were away."""
    pass_seconds: Mapped[float | None]
    keep_files_until: Mapped[datetime | None]
    """Until then the server deletes no file: a backup is being made."""


class Total(Base):
    """A count that lasts as long as the installation."""

    __tablename__ = "totals"

    name: Mapped[str] = mapped_column(String(32), primary_key=True)
    host: Mapped[str] = mapped_column(String(255), primary_key=True)
    """The machine on which it happened; empty for the server."""
    kind: Mapped[str] = mapped_column(String(32), primary_key=True)
    """The part of `name` that is counted; empty for the whole."""
    value: Mapped[float]
    changed_at: Mapped[datetime] = mapped_column(default=clock())


class Notification(Base):
    """An event of a run for the webhook; deleted once the webhook has accepted it."""

    __tablename__ = "notifications"

    id: Mapped[UUID] = mapped_column(primary_key=True, default=uuid4)
    """Repeats of an event have the same id."""
    run_id: Mapped[UUID]
    kind: Mapped[str] = mapped_column(String(32))
    data: Mapped[dict[str, Any]]
    created_at: Mapped[datetime] = mapped_column(default=clock())
    due_at: Mapped[datetime] = mapped_column(default=clock())
    tries: Mapped[int] = mapped_column(default=0)


SCOPES = ("read", "write", "admin")
"""Each scope includes those before it."""


class Token(Expiring, Base):
    """A token. The row holds the hash of the secret, never the secret."""

    __tablename__ = "tokens"
    __table_args__ = (
        CheckConstraint(f"scope IN {SCOPES}", name="scope"),
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
    prefix: Mapped[str] = mapped_column(String(16))
    """The first characters of the secret, by which its holder recognises it."""
    scope: Mapped[str] = mapped_column(String(16))
    created_at: Mapped[datetime] = mapped_column(default=clock())
    last_used_at: Mapped[datetime | None]
    max_queued: Mapped[int | None]
    """Quotas of its owner's runs; None: without limit."""
    max_running: Mapped[int | None]
    device_hours: Mapped[float | None]
    """Hours of devices in `USE_DAYS` days."""


USE_DAYS = 30
"""Days over which device hours are counted."""


class DeviceUse(Base):
    """Seconds for which the runs of an owner had a device, by day."""

    __tablename__ = "device_use"

    owner: Mapped[UUID] = mapped_column(primary_key=True)
    """The id of a token; `NOBODY` for runs without an owner."""
    day: Mapped[date] = mapped_column(primary_key=True)
    seconds: Mapped[float]


NOBODY = UUID(int=0)


ProblemKind = Literal["untested", "device", "self-test", "store", "schema", "database"]
"""`untested`: it has yet to test itself. `device`: its GPU is gone. `schema`: the tables are of
another version."""


class Worker(Base):
    """A worker as it last reported."""

    __tablename__ = "workers"

    name: Mapped[str] = mapped_column(String(255), primary_key=True)
    device: Mapped[str] = mapped_column(Text)
    kind: Mapped[str] = mapped_column(String(16))
    memory_bytes: Mapped[int] = mapped_column(BigInteger)
    memory_used_bytes: Mapped[int | None] = mapped_column(BigInteger)
    load: Mapped[float | None]
    """Load of the device by all programs: 1 is fully busy."""
    status: Mapped[str] = mapped_column(String(16))
    run_id: Mapped[UUID | None]
    since: Mapped[datetime] = mapped_column(default=clock())
    """When its status or its run last changed."""
    heartbeat_at: Mapped[datetime] = mapped_column(default=clock())
    plugins: Mapped[list[dict[str, Any]]] = mapped_column(default=list)
    unloaded: Mapped[list[dict[str, Any]]] = mapped_column(default=list)
    """Modules that it could not load: `module` and `reason`."""
    device_kinds: Mapped[list[str]] = mapped_column(default=list)
    """Kinds of devices whose results it repeats bit for bit; none before its self-test."""
    labels: Mapped[list[str]] = mapped_column(default=list)
    problem: Mapped[str | None] = mapped_column(Text)
    """The reason why the worker takes no run."""
    problem_kind: Mapped[ProblemKind | None] = mapped_column(String(16))
    gpu: Mapped[dict[str, Any] | None]
    """UUID, temperature and uncorrected memory errors of its GPU, where it has one."""


class Plugin(Base):
    """A version of a plug-in that a worker has, or had."""

    __tablename__ = "plugins"

    kind: Mapped[str] = mapped_column(String(16), primary_key=True)
    name: Mapped[str] = mapped_column(String(128), primary_key=True)
    source: Mapped[str] = mapped_column(Sha256, primary_key=True)
    declaration: Mapped[dict[str, Any]] = mapped_column(JSON())
    seen_at: Mapped[datetime] = mapped_column(default=clock())
    """When a worker first reported it, or reported it again after an absence."""
