"""Read access of a share's holder to the ordinary routes."""

from typing import Annotated, Any, Protocol
from uuid import UUID

from fastapi import Depends, Request
from sqlalchemy.orm import Session

from ..tables import Artifact, Run

SHARE_HEADER = "Microcosmos-Share"
"""The header that names a share. Answers vary by it, so caches keep them apart."""


class ShareAccess(Protocol):
    """Read access to what a share shows. The package `shares` implements it."""

    @property
    def listed(self) -> bool:
        """Search engines may list the share's page."""
        ...

    def run(self, session: Session, run_id: UUID) -> Run:
        """Return the run as shared; raise `ProblemError` if the share does not hold it."""
        ...

    def refuse_unless_holds(self, session: Session, creature: str) -> None:
        """Raise `ProblemError` if the share does not hold a creature."""
        ...

    def licensed(self, file: dict[str, Any]) -> dict[str, Any]:
        """Return a creature file under the licence of the share."""
        ...

    def archive(self, session: Session) -> Artifact:
        """Return the archive file as it was shared; raise `ProblemError` if there is none."""
        ...


async def share_access(request: Request) -> ShareAccess | None:
    """Return the view of the share of the request, if it names one."""
    return request.state.share


ShareAccessDep = Annotated[ShareAccess | None, Depends(share_access)]
