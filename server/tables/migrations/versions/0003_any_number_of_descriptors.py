"""Elites have as many descriptors as the archive has axes."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

LISTED = {
    "sqlite": "listed(descriptor_0, descriptor_1)",
    "postgresql": "json_build_array(descriptor_0, descriptor_1)",
}
PICKED = {
    "sqlite": "picked(descriptors, {0})",
    "postgresql": "coalesce(CAST(descriptors ->> {0} AS double precision), 0)",
}
"""Of the descriptors by number; one that there is not is 0."""


def upgrade() -> None:
    with op.batch_alter_table("elites", schema=None) as batch_op:
        batch_op.add_column(sa.Column("descriptors", sa.JSON(), nullable=True))
    _update(f"descriptors = {LISTED[_prepared()]}")
    with op.batch_alter_table("elites", schema=None) as batch_op:
        batch_op.alter_column("descriptors", existing_type=sa.JSON(), nullable=False)
        batch_op.drop_column("descriptor_0")
        batch_op.drop_column("descriptor_1")


def downgrade() -> None:
    """Two descriptors are kept, as many as there were room for."""
    with op.batch_alter_table("elites", schema=None) as batch_op:
        for name in ("descriptor_0", "descriptor_1"):
            batch_op.add_column(sa.Column(name, sa.Double(), nullable=True))
    pick = PICKED[_prepared()]
    _update(", ".join(f"descriptor_{i} = {pick.format(i)}" for i in (0, 1)))
    with op.batch_alter_table("elites", schema=None) as batch_op:
        for name in ("descriptor_0", "descriptor_1"):
            batch_op.alter_column(name, existing_type=sa.Double(), nullable=False)
        batch_op.drop_column("descriptors")


def _update(change: str) -> None:
    op.get_bind().execute(sa.text(f"UPDATE elites SET {change}"))


def _prepared() -> str:
    """The dialect. SQLite's own JSON may round the last digits of a number, Python's not."""
    connection = op.get_bind()
    if connection.dialect.name == "sqlite":
        driver: Any = connection.connection.dbapi_connection
        driver.create_function("listed", 2, lambda *values: json.dumps(values))
        driver.create_function("picked", 2, _picked)
    return connection.dialect.name


def _picked(text: str, number: int) -> float:
    values = json.loads(text)
    return values[number] if number < len(values) else 0.0
