"""All tables."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "creatures",
        sa.Column("sha256", sa.LargeBinary(length=32), primary_key=True),
        sa.Column("identity", sa.LargeBinary(), nullable=False),
        sa.Column("parents", sa.JSON(), nullable=False),
        sa.Column("operator", sa.Text()),
        sa.Column("measured", sa.JSON(none_as_null=True)),
        sa.Column("provenance", sa.JSON(none_as_null=True)),
        sa.Column("licence", sa.Text(), nullable=False),
        sa.Column("credit", sa.JSON(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("imported", sa.Boolean(), nullable=False),
    )
    op.create_table(
        "garbage_creatures",
        sa.Column("run_id", sa.Uuid(), primary_key=True),
        sa.Column("creature", sa.LargeBinary(length=32), primary_key=True),
    )
    op.create_table(
        "garbage_files",
        sa.Column("path", sa.String(length=255), primary_key=True),
    )
    op.create_table(
        "plugins",
        sa.Column("kind", sa.String(length=16), primary_key=True),
        sa.Column("name", sa.String(length=128), primary_key=True),
        sa.Column("source", sa.LargeBinary(length=32), primary_key=True),
        sa.Column("declaration", sa.JSON(), nullable=False),
        sa.Column("seen_at", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_table(
        "runs",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("experiment", sa.String(length=64), nullable=False),
        sa.Column("spec", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("plugin_versions", sa.JSON(none_as_null=True)),
        sa.Column("version", sa.String(length=64), nullable=False),
        sa.Column("demonstration", sa.Boolean(), nullable=False),
        sa.Column("name", sa.String(length=200)),
        sa.Column("tags", sa.JSON(), nullable=False),
        sa.Column("note", sa.Text()),
        sa.Column("status", sa.String(length=16), nullable=False),
        sa.Column("requested_state", sa.String(length=16)),
        sa.Column("requested_at", sa.DateTime(timezone=True)),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("queued_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True)),
        sa.Column("finished_at", sa.DateTime(timezone=True)),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("attempts_without_checkpoint", sa.Integer(), nullable=False),
        sa.Column("worker", sa.String(length=255)),
        sa.Column("device", sa.Text()),
        sa.Column("device_override", sa.String(length=16)),
        sa.Column("heartbeat_at", sa.DateTime(timezone=True)),
        sa.Column("generations", sa.Integer(), nullable=False),
        sa.Column("generation", sa.Integer(), nullable=False),
        sa.Column("checkpoint_generation", sa.Integer(), nullable=False),
        sa.Column("evaluations", sa.BigInteger(), nullable=False),
        sa.Column("diverged", sa.BigInteger(), nullable=False),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("qd_score", sa.Double()),
        sa.Column("coverage", sa.Double()),
        sa.Column("best", sa.Double()),
        sa.Column("summary", sa.JSON(none_as_null=True)),
        sa.Column("error", sa.Text()),
        sa.Column("warning", sa.Text()),
        sa.Column("sweep", sa.Uuid()),
        sa.Column("sweep_index", sa.Integer()),
        sa.Column("deleted_at", sa.DateTime(timezone=True)),
        sa.Column("purge_at", sa.DateTime(timezone=True)),
        sa.Column("n_initial", sa.Integer()),
        sa.Column("forked_from", sa.Uuid()),
        sa.Column("owner", sa.Uuid()),
        sa.CheckConstraint(
            "requested_state IN ('paused', 'cancelled')", name="requested_state"
        ),
        sa.CheckConstraint(
            "status IN ('queued', 'running', 'paused', 'finished', 'failed', 'cancelled')",
            name="status",
        ),
    )
    op.create_index("ix_runs_created_at_id", "runs", ["created_at", "id"])
    op.create_index("ix_runs_purge_at", "runs", ["purge_at"])
    op.create_index("ix_runs_status_heartbeat_at", "runs", ["status", "heartbeat_at"])
    op.create_index("ix_runs_sweep_sweep_index", "runs", ["sweep", "sweep_index"])
    op.create_table(
        "sweeps",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("experiment", sa.String(length=64), nullable=False),
        sa.Column("name", sa.String(length=200)),
        sa.Column("spec", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("seeds", sa.JSON(), nullable=False),
        sa.Column("grid", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("owner", sa.Uuid()),
    )
    op.create_index("ix_sweeps_created_at_id", "sweeps", ["created_at", "id"])
    op.create_table(
        "tokens",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("secret_sha256", sa.LargeBinary(length=32), nullable=False),
        sa.Column("prefix", sa.String(length=16), nullable=False),
        sa.Column("scope", sa.String(length=16), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True)),
        sa.Column("revoked_at", sa.DateTime(timezone=True)),
        sa.Column("last_used_at", sa.DateTime(timezone=True)),
        sa.CheckConstraint("scope IN ('read', 'write', 'admin')", name="scope"),
        sa.UniqueConstraint("secret_sha256"),
    )
    op.create_index(
        "ix_tokens_name",
        "tokens",
        ["name"],
        unique=True,
        sqlite_where=sa.text("revoked_at IS NULL"),
        postgresql_where=sa.text("revoked_at IS NULL"),
    )
    op.create_table(
        "workers",
        sa.Column("name", sa.String(length=255), primary_key=True),
        sa.Column("device", sa.Text(), nullable=False),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("memory_bytes", sa.BigInteger(), nullable=False),
        sa.Column("memory_used_bytes", sa.BigInteger()),
        sa.Column("load", sa.Double()),
        sa.Column("status", sa.String(length=16), nullable=False),
        sa.Column("run_id", sa.Uuid()),
        sa.Column("since", sa.DateTime(timezone=True), nullable=False),
        sa.Column("heartbeat_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("plugins", sa.JSON(), nullable=False),
        sa.Column("unloaded", sa.JSON(), nullable=False),
    )
    op.create_table(
        "artifacts",
        sa.Column("path", sa.String(length=255), primary_key=True),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE")),
        sa.Column("number", sa.Integer()),
        sa.Column("generation", sa.Integer()),
        sa.Column("creature", sa.LargeBinary(length=32), sa.ForeignKey("creatures.sha256")),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", sa.LargeBinary(length=32), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.UniqueConstraint("creature", "kind"),
        sa.UniqueConstraint("run_id", "kind", "number"),
    )
    op.create_table(
        "elites",
        sa.Column(
            "run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
        ),
        sa.Column("cell", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("generation", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("fitness", sa.Double(), nullable=False),
        sa.Column("descriptors", sa.JSON(), nullable=False),
        sa.Column(
            "creature",
            sa.LargeBinary(length=32),
            sa.ForeignKey("creatures.sha256"),
            nullable=False,
        ),
    )
    op.create_index("ix_elites_creature", "elites", ["creature"])
    op.create_table(
        "generations",
        sa.Column(
            "run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
        ),
        sa.Column("generation", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("qd_score", sa.Double()),
        sa.Column("coverage", sa.Double()),
        sa.Column("best", sa.Double()),
        sa.Column("mean", sa.Double()),
        sa.Column("evaluations", sa.BigInteger(), nullable=False),
        sa.Column("diverged", sa.BigInteger(), nullable=False),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("summary", sa.JSON(none_as_null=True)),
    )
    op.create_table(
        "idempotency",
        sa.Column("key", sa.String(length=255), primary_key=True),
        sa.Column("body_sha256", sa.LargeBinary(length=32), nullable=False),
        sa.Column("run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE")),
        sa.Column("sweep", sa.Uuid(), sa.ForeignKey("sweeps.id", ondelete="CASCADE")),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_table(
        "initial_creatures",
        sa.Column(
            "run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
        ),
        sa.Column(
            "creature",
            sa.LargeBinary(length=32),
            sa.ForeignKey("creatures.sha256"),
            primary_key=True,
        ),
    )
    op.create_index("ix_initial_creatures_creature", "initial_creatures", ["creature"])
    op.create_table(
        "log_entries",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column(
            "run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE"), nullable=False
        ),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("level", sa.String(length=16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(length=16)),
        sa.Column("text", sa.Text(), nullable=False),
    )
    op.create_index("ix_log_entries_run_id_id", "log_entries", ["run_id", "id"])
    op.create_table(
        "parents",
        sa.Column(
            "child",
            sa.LargeBinary(length=32),
            sa.ForeignKey("creatures.sha256"),
            primary_key=True,
        ),
        sa.Column("position", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("parent", sa.LargeBinary(length=32), nullable=False),
    )
    op.create_index("ix_parents_parent", "parents", ["parent"])
    op.create_table(
        "results",
        sa.Column(
            "run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE"), primary_key=True
        ),
        sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False),
        sa.Column("generation", sa.Integer(), nullable=False),
        sa.Column("values", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("creature", sa.LargeBinary(length=32), sa.ForeignKey("creatures.sha256")),
    )
    op.create_index("ix_results_creature", "results", ["creature"])
    op.create_table(
        "shares",
        sa.Column("slug", sa.String(length=43), primary_key=True),
        sa.Column("creature", sa.LargeBinary(length=32), sa.ForeignKey("creatures.sha256")),
        sa.Column("run_id", sa.Uuid(), sa.ForeignKey("runs.id", ondelete="CASCADE")),
        sa.Column("generation", sa.Integer()),
        sa.Column(
            "cover",
            sa.LargeBinary(length=32),
            sa.ForeignKey("creatures.sha256"),
            nullable=False,
        ),
        sa.Column("title", sa.Text(), nullable=False),
        sa.Column("credit", sa.JSON(), nullable=False),
        sa.Column("licence", sa.Text(), nullable=False),
        sa.Column("listed", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True)),
        sa.Column("revoked_at", sa.DateTime(timezone=True)),
        sa.Column("owner", sa.Uuid()),
        sa.CheckConstraint("(creature IS NULL) <> (run_id IS NULL)", name="one_thing"),
    )
    op.create_index("ix_shares_created_at_slug", "shares", ["created_at", "slug"])


def downgrade() -> None:
    for name in (
        "shares",
        "results",
        "parents",
        "log_entries",
        "initial_creatures",
        "idempotency",
        "generations",
        "elites",
        "artifacts",
        "workers",
        "tokens",
        "sweeps",
        "runs",
        "plugins",
        "garbage_files",
        "garbage_creatures",
        "creatures",
    ):
        op.drop_table(name)
