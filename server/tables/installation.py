"""The table of the installation itself."""

from datetime import datetime
from uuid import UUID

from sqlalchemy.orm import Mapped, mapped_column

from .base import Base


class InstallationId(Base):
    """The one row that names this database and its store; the migration inserts it."""

    __tablename__ = "installation"

    id: Mapped[UUID] = mapped_column(primary_key=True)
    keep_files_until: Mapped[datetime | None]
    """Until then the server deletes no file: a backup is being made."""
