"""Create all tables as the models describe them.

Nothing has been released yet: a change of a model changes this revision too, and a database of
an earlier commit has to be made anew. The first release freezes this revision: replace
`create_all` by the operations that `alembic revision --autogenerate` writes.
"""

from uuid import uuid4

import sqlalchemy as sa
from alembic import op

from microcosmos_server.tables import Base, InstallationState

revision = "0001"
down_revision = branch_labels = depends_on = None


def upgrade() -> None:
    Base.metadata.create_all(op.get_bind())
    # `mark.fault` compares the id of this one row with the file in the store.
    op.get_bind().execute(sa.insert(InstallationState).values(id=uuid4()))


def downgrade() -> None:
    Base.metadata.drop_all(op.get_bind())
