"""The table of the installation itself."""

from datetime import datetime
from uuid import UUID

from sqlalchemy.orm import Mapped, mapped_column

from .base import Base


class InstallationState(Base):
    """The one row of the installation; the migration inserts it."""

    __tablename__ = "installation"

    id: Mapped[UUID] = mapped_column(primary_key=True)
    """Names this database and its store."""
    verdicts: Mapped[int] = mapped_column(default=0)
    """Counts changes of the verdicts of audits, which archives show."""
    reconciled_at: Mapped[datetime | None]
    """When a server last began the periodic work; another one waits for its turn."""
    passed_at: Mapped[datetime | None]
    """When a server last completed it."""
    pass_seconds: Mapped[float | None]
    keep_files_until: Mapped[datetime | None]
    """Until then the server deletes no file: a backup is being made."""
