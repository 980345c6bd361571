"""Tables of results: curves, rows of tables, elites."""

from typing import Any

from sqlalchemy import BigInteger, ForeignKey, Index
from sqlalchemy.orm import Mapped, mapped_column

from .base import Base, Place, RunKey, Sha256

CORRECTED = ("corrected_qd_score", "corrected_coverage", "hit_rate")
"""Figures in the summary of a generation whose elites were reevaluated."""


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
    """Its place in the whole table, from 0."""
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
