"""Authorise the holder of a share: open it, and read only what it shows."""

from dataclasses import dataclass
from typing import Any
from uuid import UUID

from sqlalchemy.orm import Session

from ..core.errors import ProblemError
from ..services.services import Services
from ..tables import Artifact, Run, Share
from . import archive_files, publishing


@dataclass(frozen=True)
class LiveShare:
    """Read access to what a live share shows."""

    share: Share

    @property
    def listed(self) -> bool:
        return self.share.listed

    def run(self, session: Session, run_id: UUID) -> Run:
        if self.share.run_id is None or run_id != self.share.run_id:
            raise ProblemError(404, "Not found", f"This share holds no run of the id {run_id}.")
        return publishing.run_as_shared(session, self.share)

    def refuse_unless_holds(self, session: Session, creature: str) -> None:
        if not publishing.holds(session, self.share, creature):
            detail = f"This share holds no creature of the name {creature}."
            raise ProblemError(404, "Not found", detail)

    def licensed(self, file: dict[str, Any]) -> dict[str, Any]:
        return publishing.licensed(self.share, file)

    def archive(self, session: Session) -> Artifact:
        found = archive_files.find(session, self.share)
        if found is None:
            generation = self.share.generation
            detail = f"The share has no file of generation {generation}; its elites are shown."
            raise ProblemError(404, "No file", detail)
        return found


def open_share(services: Services, slug: str) -> LiveShare:
    """Return the view of a live share; raise `ProblemError` 404 or 410."""
    with services.sessions.read() as session:
        return LiveShare(publishing.find_live(session, slug))
