"""Runs have names, tags and notes and a place in the queue; workers tell how busy they are."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("name", sa.String(200), nullable=True))
        batch_op.add_column(sa.Column("tags", sa.JSON(), nullable=True))
        batch_op.add_column(sa.Column("note", sa.Text(), nullable=True))
        batch_op.add_column(sa.Column("queued_at", sa.DateTime(timezone=True), nullable=True))
    op.execute("UPDATE runs SET tags = '[]', queued_at = created_at")
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.alter_column("tags", existing_type=sa.JSON(), nullable=False)
        batch_op.alter_column(
            "queued_at", existing_type=sa.DateTime(timezone=True), nullable=False
        )
    op.execute("DELETE FROM workers")  # Those that live report again within seconds.
    with op.batch_alter_table("workers", schema=None) as batch_op:
        batch_op.add_column(sa.Column("kind", sa.String(16), nullable=False))
        batch_op.add_column(sa.Column("memory_used_bytes", sa.BigInteger(), nullable=True))
        batch_op.add_column(sa.Column("load", sa.Double(), nullable=True))
        batch_op.add_column(sa.Column("since", sa.DateTime(timezone=True), nullable=False))


def downgrade() -> None:
    for name in ("since", "load", "memory_used_bytes", "kind"):
        op.drop_column("workers", name)
    for name in ("queued_at", "note", "tags", "name"):
        op.drop_column("runs", name)
