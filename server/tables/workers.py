"""Tables of workers and of the plug-ins that they offer."""

from datetime import datetime
from typing import Any, Literal
from uuid import UUID

from sqlalchemy import JSON, BigInteger, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Sha256

ProblemKind = Literal["untested", "device", "self-test", "store"]
"""`untested`: it has yet to test itself. `device`: its GPU is gone."""


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
    """Why it takes no run."""
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
