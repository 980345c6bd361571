"""Links from creatures to their parents, so that children are found."""

import json

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None

AT_ONCE = 500


def upgrade() -> None:
    links = op.create_table(
        "parents",
        sa.Column("child", sa.LargeBinary(length=32), nullable=False),
        sa.Column("place", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("parent", sa.LargeBinary(length=32), nullable=False),
        sa.ForeignKeyConstraint(["child"], ["creatures.sha256"], name=op.f("fk_parents_child")),
        sa.PrimaryKeyConstraint("child", "place", name=op.f("pk_parents")),
    )
    with op.batch_alter_table("parents", schema=None) as batch_op:
        batch_op.create_index(batch_op.f("ix_parents_parent"), ["parent"], unique=False)
    _link(links)


def _link(links: sa.Table) -> None:
    """Every creature's links, a few hundred creatures at a time."""
    asked = sa.text(
        "SELECT sha256, parents FROM creatures WHERE sha256 > :last ORDER BY sha256 LIMIT :most"
    )
    connection, last = op.get_bind(), b""
    while some := connection.execute(asked, {"last": last, "most": AT_ONCE}).all():
        last = some[-1][0]
        rows = [
            {"child": child, "place": place, "parent": bytes.fromhex(parent)}
            for child, parents in some
            for place, parent in enumerate(_listed(parents))
        ]
        if rows:
            connection.execute(links.insert(), rows)


def _listed(parents: str | list[str] | None) -> list[str]:
    """SQLite gives the text of JSON, PostgreSQL what it says."""
    return (json.loads(parents) if isinstance(parents, str) else parents) or []


def downgrade() -> None:
    op.drop_table("parents")
