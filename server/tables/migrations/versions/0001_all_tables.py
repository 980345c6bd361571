"""All tables."""

from typing import Any
from uuid import uuid4

import sqlalchemy as sa
from alembic import op

from server.tables.migrations.columns import (
    FIGURES,
    HASH,
    JSON_OR_NULL,
    KEYS,
    MOMENT,
    numbered,
    optional,
    required,
    to_creature,
    to_run,
)

revision = "0001"
down_revision = branch_labels = depends_on = None


def upgrade() -> None:
    for create in (
        *(_installation, _creatures, _workers, _runs, _sweeps_and_logs, _tokens),
        *(_files, _results, _shares, _operation),
    ):
        create()


def _installation() -> None:
    table = op.create_table(
        "installation",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("verdicts", sa.Integer(), nullable=False),
        *optional(MOMENT, "reconciled_at", "passed_at", "keep_files_until"),
        sa.Column("pass_seconds", sa.Double()),
    )
    op.bulk_insert(table, [{"id": uuid4(), "verdicts": 0}])


def _creatures() -> None:
    op.create_table(
        "creatures",
        sa.Column("sha256", HASH, primary_key=True),
        sa.Column("trusted", sa.Boolean()),
        sa.Column("identity", sa.LargeBinary(), nullable=False),
        *required(sa.JSON(), "parents", "credit"),
        sa.Column("operator", sa.Text()),
        *optional(JSON_OR_NULL, "measured", "provenance"),
        sa.Column("licence", sa.Text(), nullable=False),
        sa.Column("created_at", MOMENT, nullable=False),
        sa.Column("imported", sa.Boolean(), nullable=False),
        sa.Column("poses", sa.LargeBinary()),
    )
    op.create_table(
        "garbage_creatures",
        sa.Column("run_id", sa.Uuid(), primary_key=True),
        sa.Column("creature", HASH, primary_key=True),
    )
    op.create_table(
        "parents",
        sa.Column("child", HASH, to_creature(), primary_key=True),
        *numbered("position"),
        sa.Column("parent", HASH, nullable=False),
    )
    op.create_index("ix_parents_parent", "parents", ["parent"])


def _workers() -> None:
    op.create_table(
        "plugins",
        sa.Column("kind", sa.String(length=16), primary_key=True),
        sa.Column("name", sa.String(length=128), primary_key=True),
        sa.Column("source", HASH, primary_key=True),
        sa.Column("declaration", sa.JSON(), nullable=False),
        sa.Column("seen_at", MOMENT, nullable=False),
    )
    op.create_table(
        "workers",
        sa.Column("name", sa.String(length=255), primary_key=True),
        sa.Column("device", sa.Text(), nullable=False),
        *required(sa.String(length=16), "kind", "status"),
        sa.Column("memory_bytes", sa.BigInteger(), nullable=False),
        sa.Column("memory_used_bytes", sa.BigInteger()),
        sa.Column("load", sa.Double()),
        sa.Column("run_id", sa.Uuid()),
        *required(MOMENT, "since", "heartbeat_at"),
        *required(sa.JSON(), "plugins", "unloaded", "device_kinds", "labels"),
        sa.Column("problem", sa.Text()),
        sa.Column("problem_kind", sa.String(length=16)),
        sa.Column("gpu", JSON_OR_NULL),
    )


def _runs() -> None:
    op.create_table(
        "runs",
        sa.Column("id", sa.Uuid(), primary_key=True),
        *required(sa.String(length=64), "experiment", "version"),
        sa.Column("spec", JSON_OR_NULL, nullable=False),
        *optional(JSON_OR_NULL, "plugin_versions", "summary", "sinks"),
        *required(sa.Boolean(), "demonstration", "interrupted", "may_yield"),
        sa.Column("name", sa.String(length=200)),
        *required(sa.JSON(), "tags", "labels"),
        *optional(sa.Text(), "note", "device", "error", "warning"),
        *required(sa.String(length=16), "status", "priority"),
        sa.Column("requested_state", sa.String(length=16)),
        sa.Column("memory_bytes", sa.BigInteger()),
        *optional(MOMENT, "requested_at", "released_at", "started_at", "finished_at"),
        *optional(MOMENT, "heartbeat_at", "deleted_at", "purge_at"),
        *required(MOMENT, "created_at", "queued_at"),
        *required(sa.Integer(), "attempt", "attempts_without_checkpoint", "rewinds"),
        *required(sa.Integer(), "generations", "generation", "begun_generation"),
        sa.Column("checkpoint_generation", sa.Integer(), nullable=False),
        *optional(sa.String(length=255), "worker", "avoided_worker"),
        *required(sa.BigInteger(), "evaluations", "infeasible"),
        sa.Column("seconds", sa.Double(), nullable=False),
        *optional(sa.Double(), "qd_score", "coverage", "best", "device_patience"),
        *optional(sa.Double(), "corrected_qd_score", "corrected_coverage", "hit_rate"),
        *optional(sa.Uuid(), "sweep", "forked_from", "owner"),
        *optional(sa.Integer(), "sweep_index", "n_initial"),
        sa.CheckConstraint(
            "requested_state IN ('paused', 'cancelled', 'queued')", name="requested_state"
        ),
        sa.CheckConstraint("priority IN ('low', 'normal', 'high', 'urgent')", name="priority"),
        sa.CheckConstraint(
            "status IN ('queued', 'running', 'paused', 'finished', 'failed', 'cancelled')",
            name="status",
        ),
    )
    orders = [[name, "id"] for name in ("created_at", "started_at", "finished_at", *FIGURES)]
    others = (["purge_at"], ["status", "heartbeat_at"], ["sweep", "sweep_index"])
    for columns in (*orders, *others):
        op.create_index("_".join(("ix_runs", *columns)), "runs", columns)
    for name, key in KEYS.items():
        op.create_index(f"ix_runs_{name}_id", "runs", [sa.text(f"({key})"), "id"])


def _sweeps_and_logs() -> None:
    op.create_table(
        "sweeps",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("experiment", sa.String(length=64), nullable=False),
        sa.Column("name", sa.String(length=200)),
        *required(JSON_OR_NULL, "spec", "grid"),
        sa.Column("seeds", sa.JSON(), nullable=False),
        sa.Column("created_at", MOMENT, nullable=False),
        sa.Column("owner", sa.Uuid()),
    )
    op.create_index("ix_sweeps_created_at_id", "sweeps", ["created_at", "id"])
    op.create_table(
        "idempotency",
        sa.Column("key", sa.String(length=255), primary_key=True),
        sa.Column("body_sha256", HASH, nullable=False),
        sa.Column("run_id", sa.Uuid(), to_run()),
        sa.Column("sweep", sa.Uuid(), sa.ForeignKey("sweeps.id", ondelete="CASCADE")),
        sa.Column("created_at", MOMENT, nullable=False),
    )
    op.create_table(
        "log_entries",
        sa.Column("id", sa.Integer(), primary_key=True),
        sa.Column("run_id", sa.Uuid(), to_run(), nullable=False),
        sa.Column("at", MOMENT, nullable=False),
        sa.Column("level", sa.String(length=16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(length=16)),
        sa.Column("text", sa.Text(), nullable=False),
    )
    op.create_index("ix_log_entries_run_id_id", "log_entries", ["run_id", "id"])


def _tokens() -> None:
    op.create_table(
        "tokens",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("name", sa.String(length=64), nullable=False),
        sa.Column("secret_sha256", HASH, nullable=False),
        *required(sa.String(length=16), "prefix", "scope"),
        sa.Column("created_at", MOMENT, nullable=False),
        *optional(MOMENT, "expires_at", "revoked_at", "last_used_at"),
        *optional(sa.Integer(), "max_queued", "max_running"),
        sa.Column("device_hours", sa.Double()),
        sa.CheckConstraint("scope IN ('read', 'write', 'admin')", name="scope"),
        sa.UniqueConstraint("secret_sha256"),
    )
    live = sa.text("revoked_at IS NULL")
    where: dict[str, Any] = {"sqlite_where": live, "postgresql_where": live}
    op.create_index("ix_tokens_name", "tokens", ["name"], unique=True, **where)
    op.create_table(
        "device_use",
        sa.Column("owner", sa.Uuid(), primary_key=True),
        sa.Column("day", sa.Date(), primary_key=True),
        sa.Column("seconds", sa.Double(), nullable=False),
    )


def _files() -> None:
    op.create_table("garbage_files", sa.Column("path", sa.String(length=255), primary_key=True))
    op.create_table(
        "artifacts",
        sa.Column("path", sa.String(length=255), primary_key=True),
        sa.Column("kind", sa.String(length=16), nullable=False),
        sa.Column("run_id", sa.Uuid(), to_run()),
        *optional(sa.Integer(), "number", "generation"),
        sa.Column("creature", HASH, to_creature()),
        sa.Column("size", sa.BigInteger(), nullable=False),
        sa.Column("sha256", HASH, nullable=False),
        sa.Column("created_at", MOMENT, nullable=False),
        sa.UniqueConstraint("creature", "kind"),
        sa.UniqueConstraint("run_id", "kind", "number"),
    )
    for name, numbers in {"initial_creatures": (), "choices": ("generation",)}.items():
        op.create_table(
            name,
            sa.Column("run_id", sa.Uuid(), to_run(), primary_key=True),
            *numbered(*numbers),
            sa.Column("creature", HASH, to_creature(), primary_key=True),
        )


def _results() -> None:
    op.create_table(
        "elites",
        sa.Column("run_id", sa.Uuid(), to_run(), primary_key=True),
        *numbered("cell", "generation"),
        sa.Column("fitness", sa.Double()),
        sa.Column("descriptors", sa.JSON()),
        sa.Column("creature", HASH, to_creature()),
    )
    op.create_index("ix_elites_run_id_fitness_cell", "elites", ["run_id", "fitness", "cell"])
    op.create_table(
        "generations",
        sa.Column("run_id", sa.Uuid(), to_run(), primary_key=True),
        *numbered("generation"),
        *optional(sa.Double(), "qd_score", "coverage", "best", "mean"),
        *required(sa.BigInteger(), "evaluations", "infeasible"),
        sa.Column("seconds", sa.Double(), nullable=False),
        sa.Column("summary", JSON_OR_NULL),
    )
    op.create_table(
        "results",
        sa.Column("run_id", sa.Uuid(), to_run(), primary_key=True),
        *numbered("number"),
        sa.Column("generation", sa.Integer(), nullable=False),
        sa.Column("values", JSON_OR_NULL, nullable=False),
        sa.Column("creature", HASH, to_creature()),
    )
    for name in ("initial_creatures", "choices", "elites", "results"):
        op.create_index(f"ix_{name}_creature", name, ["creature"])


def _shares() -> None:
    op.create_table(
        "shares",
        sa.Column("slug", sa.String(length=43), primary_key=True),
        sa.Column("creature", HASH, to_creature()),
        sa.Column("run_id", sa.Uuid(), to_run()),
        sa.Column("generation", sa.Integer()),
        sa.Column("cover", HASH, to_creature(), nullable=False),
        *required(sa.Text(), "title", "licence"),
        sa.Column("credit", sa.JSON(), nullable=False),
        sa.Column("listed", sa.Boolean(), nullable=False),
        sa.Column("created_at", MOMENT, nullable=False),
        *optional(MOMENT, "expires_at", "revoked_at"),
        sa.Column("owner", sa.Uuid()),
        sa.CheckConstraint("(creature IS NULL) <> (run_id IS NULL)", name="one_thing"),
    )
    op.create_index("ix_shares_created_at_slug", "shares", ["created_at", "slug"])


def _operation() -> None:
    op.create_table(
        "totals",
        sa.Column("name", sa.String(length=32), primary_key=True),
        sa.Column("host", sa.String(length=255), primary_key=True),
        sa.Column("kind", sa.String(length=32), primary_key=True),
        sa.Column("value", sa.Double(), nullable=False),
        sa.Column("changed_at", MOMENT, nullable=False),
    )
    op.create_table(
        "notifications",
        sa.Column("id", sa.Uuid(), primary_key=True),
        sa.Column("run_id", sa.Uuid(), nullable=False),
        sa.Column("kind", sa.String(length=32), nullable=False),
        sa.Column("data", JSON_OR_NULL, nullable=False),
        *required(MOMENT, "created_at", "due_at"),
        sa.Column("tries", sa.Integer(), nullable=False),
    )


def downgrade() -> None:
    tables = sa.inspect(op.get_bind()).get_table_names()
    metadata = sa.MetaData()
    metadata.reflect(op.get_bind(), only=[name for name in tables if name != "alembic_version"])
    metadata.drop_all(op.get_bind())
