"""Run by Alembic: migrate over the connection that the caller gave."""

from typing import Any, Literal

from alembic import context
from sqlalchemy.types import TypeDecorator

from server.tables import Base


def render_base_type(kind: str, item: Any, _: Any) -> str | Literal[False]:
    """Write our column types as their base types: a migration must not change with them."""
    return f"sa.{item.impl!r}" if kind == "type" and isinstance(item, TypeDecorator) else False


context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    render_as_batch=True,
    render_item=render_base_type,
    transactional_ddl=True,
)
context.run_migrations()
