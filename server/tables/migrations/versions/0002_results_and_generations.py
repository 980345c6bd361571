"""Results that are tables; how many generations a run will have."""

import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "results",
        sa.Column("run_id", sa.Uuid(), nullable=False),
        sa.Column("number", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("generation", sa.Integer(), nullable=False),
        sa.Column("values", sa.JSON(), nullable=False),
        sa.Column("creature", sa.LargeBinary(length=32), nullable=True),
        sa.ForeignKeyConstraint(
            ["creature"], ["creatures.sha256"], name=op.f("fk_results_creature")
        ),
        sa.ForeignKeyConstraint(
            ["run_id"], ["runs.id"], name=op.f("fk_results_run_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("run_id", "number", name=op.f("pk_results")),
    )
    with op.batch_alter_table("generations", schema=None) as batch_op:
        batch_op.add_column(sa.Column("summary", sa.JSON(), nullable=True))
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.add_column(sa.Column("summary", sa.JSON(), nullable=True))
        batch_op.add_column(sa.Column("generations", sa.Integer(), nullable=True))
    _count_generations()
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.alter_column("generations", existing_type=sa.Integer(), nullable=False)


def _count_generations() -> None:
    """All runs so far search an archive, and their specs say for how long."""
    connection = op.get_bind()
    for run_id, spec in connection.execute(sa.text("SELECT id, spec FROM runs")).all():
        document: Any = json.loads(spec) if isinstance(spec, str) else spec
        connection.execute(
            sa.text("UPDATE runs SET generations = :generations WHERE id = :id"),
            {"generations": document["search"]["generations"], "id": run_id},
        )


def downgrade() -> None:
    with op.batch_alter_table("runs", schema=None) as batch_op:
        batch_op.drop_column("generations")
        batch_op.drop_column("summary")
    with op.batch_alter_table("generations", schema=None) as batch_op:
        batch_op.drop_column("summary")
    op.drop_table("results")
