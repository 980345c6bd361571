"""Runs that were asked for together."""

from datetime import datetime
from typing import Any
from uuid import UUID, uuid4

from sqlalchemy import Index, String
from sqlalchemy.orm import Mapped, mapped_column

from ..core.database import clock
from .base import Base, Owned


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
