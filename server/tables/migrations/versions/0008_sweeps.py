"""Sweeps: runs that were asked for together, each with its place among them."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "sweeps",
        sa.Column("id", sa.Uuid(), nullable=False),
        sa.Column("experiment", sa.String(64), nullable=False),
        sa.Column("name", sa.String(200), nullable=True),
        sa.Column("spec", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("seeds", sa.JSON(), nullable=False),
        sa.Column("grid", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_sweeps")),
    )
    op.create_index(op.f("ix_sweeps_created_at_id"), "sweeps", ["created_at", "id"])
    op.add_column("runs", sa.Column("sweep", sa.Uuid(), nullable=True))
    op.add_column("runs", sa.Column("place", sa.Integer(), nullable=True))
    op.create_index(op.f("ix_runs_sweep_place"), "runs", ["sweep", "place"])
    with op.batch_alter_table("idempotency", schema=None) as batch_op:
        batch_op.add_column(sa.Column("sweep", sa.Uuid(), nullable=True))
        batch_op.alter_column("run_id", existing_type=sa.Uuid(), nullable=True)
        batch_op.create_foreign_key(
            batch_op.f("fk_idempotency_sweep"),
            "sweeps",
            ["sweep"],
            ["id"],
            ondelete="CASCADE",
        )


def downgrade() -> None:
    op.execute("DELETE FROM idempotency WHERE run_id IS NULL")
    with op.batch_alter_table("idempotency", schema=None) as batch_op:
        batch_op.drop_constraint(batch_op.f("fk_idempotency_sweep"), type_="foreignkey")
        batch_op.alter_column("run_id", existing_type=sa.Uuid(), nullable=False)
        batch_op.drop_column("sweep")
    op.drop_index(op.f("ix_runs_sweep_place"), "runs")
    for name in ("place", "sweep"):
        op.drop_column("runs", name)
    op.drop_table("sweeps")
