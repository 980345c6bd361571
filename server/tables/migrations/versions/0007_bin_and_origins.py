"""Runs that lie in the bin, runs that begin from creatures, and what goes with a run."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

SHA256 = sa.LargeBinary(length=32)


def upgrade() -> None:
    for name in ("deleted_at", "purge_at"):
        op.add_column("runs", sa.Column(name, sa.DateTime(timezone=True), nullable=True))
    op.add_column("runs", sa.Column("forked", sa.Integer(), nullable=True))
    op.add_column("runs", sa.Column("forked_from", sa.Uuid(), nullable=True))
    op.create_index(op.f("ix_runs_purge_at"), "runs", ["purge_at"])
    for table in ("elites", "results"):
        op.create_index(op.f(f"ix_{table}_creature"), table, ["creature"])
    _mark_imported()
    _create_tables()


def _mark_imported() -> None:
    """Of before, what is in no run can only have been brought, or was once rewound."""
    imported = sa.Column("imported", sa.Boolean(), nullable=False, server_default=sa.false())
    op.add_column("creatures", imported)
    of_runs = " AND ".join(
        f"NOT EXISTS (SELECT 1 FROM {table} WHERE {table}.creature = creatures.sha256)"
        for table in ("elites", "results")
    )
    op.execute(f"UPDATE creatures SET imported = true WHERE {of_runs}")


def _create_tables() -> None:
    op.create_table(
        "origins",
        sa.Column("run_id", sa.Uuid(), nullable=False),
        sa.Column("creature", SHA256, nullable=False),
        sa.ForeignKeyConstraint(
            ["run_id"], ["runs.id"], name=op.f("fk_origins_run_id"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["creature"], ["creatures.sha256"], name=op.f("fk_origins_creature")
        ),
        sa.PrimaryKeyConstraint("run_id", "creature", name=op.f("pk_origins")),
    )
    op.create_index(op.f("ix_origins_creature"), "origins", ["creature"])
    op.create_table(
        "leftovers",
        sa.Column("run_id", sa.Uuid(), nullable=False),
        sa.Column("creature", SHA256, nullable=False),
        sa.PrimaryKeyConstraint("run_id", "creature", name=op.f("pk_leftovers")),
    )
    op.create_table(
        "discarded",
        sa.Column("path", sa.String(length=255), nullable=False),
        sa.PrimaryKeyConstraint("path", name=op.f("pk_discarded")),
    )


def downgrade() -> None:
    for table in ("discarded", "leftovers", "origins"):
        op.drop_table(table)
    for table in ("results", "elites"):
        op.drop_index(op.f(f"ix_{table}_creature"), table)
    op.drop_index(op.f("ix_runs_purge_at"), "runs")
    op.drop_column("creatures", "imported")
    for name in ("forked_from", "forked", "purge_at", "deleted_at"):
        op.drop_column("runs", name)
