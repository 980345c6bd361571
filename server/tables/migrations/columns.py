"""Columns of several tables, in short, for the migration."""

from typing import Any

import sqlalchemy as sa

HASH, MOMENT = sa.LargeBinary(length=32), sa.DateTime(timezone=True)
JSON_OR_NULL = sa.JSON(none_as_null=True)

FIGURES = ("experiment", "evaluations", "qd_score", "coverage", "best")
"""Columns by which runs are ordered."""
KEYS = {
    "name": "lower(name)",
    "status": "CASE status WHEN 'queued' THEN 0 WHEN 'running' THEN 1 WHEN 'paused' THEN 2"
    " WHEN 'finished' THEN 3 WHEN 'failed' THEN 4 WHEN 'cancelled' THEN 5 END",
    "progress": "CASE WHEN status = 'finished' THEN 1.0"
    " ELSE CAST(generation AS DOUBLE PRECISION) / generations END",
}
"""Keys of orders of runs that are no columns."""


def required(kind: Any, *names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind, nullable=False) for name in names]


def optional(kind: Any, *names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind) for name in names]


def numbered(*names: str) -> list[sa.Column[Any]]:
    """Return columns of a key that are numbers of a row."""
    return [
        sa.Column(name, sa.Integer(), primary_key=True, autoincrement=False) for name in names
    ]


def to_creature() -> sa.ForeignKey:
    return sa.ForeignKey("creatures.sha256")


def to_run() -> sa.ForeignKey:
    return sa.ForeignKey("runs.id", ondelete="CASCADE")
