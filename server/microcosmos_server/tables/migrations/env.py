"""Run by Alembic: migrate over the connection that the caller gave."""

from typing import Any, Literal

from alembic import context
from sqlalchemy.types import TypeDecorator

from microcosmos_server.tables import Base

EXPRESSIONS = ("ix_runs_name_id", "ix_runs_status_id", "ix_runs_progress_id")


def render_base_type(kind: str, item: Any, _: Any) -> str | Literal[False]:
    """Write our column types as their base types: a migration must not change with them."""
    return f"sa.{item.impl!r}" if kind == "type" and isinstance(item, TypeDecorator) else False


def is_comparable(_: Any, name: str | None, kind: str, *__: Any) -> bool:
    """Leave out indexes of expressions: databases rewrite those, so they always differ."""
    return kind != "index" or name not in EXPRESSIONS


context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    render_as_batch=True,
    render_item=render_base_type,
    include_object=is_comparable,
    transactional_ddl=True,
)
context.run_migrations()
