"""What people share, and whom a creature's file asks to name."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("creatures", schema=None) as batch_op:
        batch_op.add_column(
            sa.Column("credit", sa.JSON(), nullable=False, server_default=sa.text("'[]'"))
        )
    with op.batch_alter_table("creatures", schema=None) as batch_op:
        batch_op.alter_column("credit", existing_type=sa.JSON(), server_default=None)
    op.create_table(
        "shares",
        sa.Column("slug", sa.String(length=43), nullable=False),
        sa.Column("creature", sa.LargeBinary(length=32), nullable=True),
        sa.Column("run_id", sa.Uuid(), nullable=True),
        sa.Column("generation", sa.Integer(), nullable=True),
        sa.Column("cover", sa.LargeBinary(length=32), nullable=False),
        sa.Column("title", sa.Text(), nullable=False),
        sa.Column("credit", sa.JSON(), nullable=False),
        sa.Column("licence", sa.Text(), nullable=False),
        sa.Column("listed", sa.Boolean(), nullable=False),
        sa.Column("owner", sa.Uuid(), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("revoked_at", sa.DateTime(timezone=True), nullable=True),
        sa.CheckConstraint(
            "(creature IS NULL) <> (run_id IS NULL)", name=op.f("ck_shares_one_thing")
        ),
        sa.ForeignKeyConstraint(
            ["creature"], ["creatures.sha256"], name=op.f("fk_shares_creature")
        ),
        sa.ForeignKeyConstraint(["cover"], ["creatures.sha256"], name=op.f("fk_shares_cover")),
        sa.ForeignKeyConstraint(
            ["run_id"], ["runs.id"], name=op.f("fk_shares_run_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("slug", name=op.f("pk_shares")),
    )
    with op.batch_alter_table("shares", schema=None) as batch_op:
        batch_op.create_index(
            batch_op.f("ix_shares_created_at_slug"), ["created_at", "slug"], unique=False
        )


def downgrade() -> None:
    op.drop_table("shares")
    op.drop_column("creatures", "credit")
