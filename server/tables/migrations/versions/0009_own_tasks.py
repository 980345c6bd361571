"""Workers tell what they have of one's own, which is remembered; runs say what they need."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "plugins",
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("name", sa.String(length=128), nullable=False),
        sa.Column("source", sa.LargeBinary(length=32), nullable=False),
        sa.Column("declaration", sa.JSON(), nullable=False),
        sa.Column("seen_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("kind", "name", "source", name=op.f("pk_plugins")),
    )
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("sources", sa.JSON(), nullable=True))
    op.execute("DELETE FROM workers")  # Those that live report again within seconds.
    with op.batch_alter_table("workers", schema=None) as batch_op:
        batch_op.add_column(sa.Column("plugins", sa.JSON(), nullable=False))
        batch_op.add_column(sa.Column("unloaded", sa.JSON(), nullable=False))


def downgrade() -> None:
    op.drop_column("workers", "unloaded")
    op.drop_column("workers", "plugins")
    op.drop_column("runs", "sources")
    op.drop_table("plugins")
