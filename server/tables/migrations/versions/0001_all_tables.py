"""All tables as the models declare them.

Nothing has been released, so tables change in place. The first release replaces this revision
by a generated one, which later changes of the models leave as it is.
"""

from alembic import op

from server.tables import Base

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    Base.metadata.create_all(op.get_bind())


def downgrade() -> None:
    Base.metadata.drop_all(op.get_bind())
