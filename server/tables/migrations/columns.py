"""Columns of several tables, in short, for the migration."""

from typing import Any

import sqlalchemy as sa

HASH, MOMENT = sa.LargeBinary(length=32), sa.DateTime(timezone=True)
JSON_OR_NULL = sa.JSON(none_as_null=True)


def required(kind: Any, *names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind, nullable=False) for name in names]


def optional(kind: Any, *names: str) -> list[sa.Column[Any]]:
    return [sa.Column(name, kind) for name in names]


def to_creature() -> sa.ForeignKey:
    return sa.ForeignKey("creatures.sha256")


def to_run() -> sa.ForeignKey:
    return sa.ForeignKey("runs.id", ondelete="CASCADE")
