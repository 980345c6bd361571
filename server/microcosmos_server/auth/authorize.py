"""Authorise a request: the scope of its route, the owner of a row, the share it names."""

from typing import Annotated, Any, Protocol
from uuid import UUID

from fastapi import Depends, Request, Security
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer, SecurityScopes
from sqlalchemy import inspect
from sqlalchemy.orm import Session

from ..core.errors import Forbidden
from ..services.services import Services
from ..tables import Artifact, Owned, Run
from . import tokens
from .principal import ADMIN, READ, SHARE, WRITE, Principal

BEARER = HTTPBearer(
    scheme_name="token", description="Where the server needs a token.", auto_error=False
)


async def authorize(
    request: Request,
    required: SecurityScopes,
    _: Annotated[HTTPAuthorizationCredentials | None, Depends(BEARER)],
) -> Principal:
    """Return the principal of the request; raise `DomainError` if it lacks a scope."""
    principal = request.state.principal
    if principal is None:
        raise request.state.refuse()
    for scope in required.scopes:
        if not principal.may(scope):
            detail = f"This needs a token of scope `{scope}`; "
            detail += f"`{principal.name}` has `{principal.scope}`."
            raise Forbidden(detail)
    return principal


async def public() -> None:
    """Mark a route that needs no token."""


MAY_READ_SHARED = Security(authorize, scopes=[SHARE])
"""The holder of a share may read too, but only what the share shows."""
MAY_READ = Security(authorize, scopes=[READ])
MAY_WRITE = Security(authorize, scopes=[WRITE])
MAY_ADMINISTER = Security(authorize, scopes=[ADMIN])
PUBLIC = Depends(public)

Reader = Annotated[Principal, MAY_READ]
Writer = Annotated[Principal, MAY_WRITE]


def authorize_owner(
    services: Services, principal: Principal, table: type[Owned], key: Any
) -> None:
    """Raise `DomainError` unless the principal owns the row or is an admin.

    If the row is missing, do nothing: the route answers that it is missing.
    """
    if principal.may(ADMIN):
        return
    with services.sessions.read() as session:
        row = session.get(table, key)
        if row is not None:
            refuse_non_owner(session, principal, row, "change")


def refuse_non_owner(session: Session, principal: Principal, row: Owned, action: str) -> None:
    """Raise `DomainError` unless the principal owns the row or is an admin."""
    if principal.may(ADMIN) or row.owner == principal.token:
        return
    owner = tokens.owner_names(session, [row.owner]).get(row.owner)
    whose = f"belongs to `{owner}`" if owner else "was made without a token"
    (key,) = inspect(row).identity
    detail = (
        f"The {type(row).__name__.lower()} {key} {whose}: only "
        f"{'its owner or ' if owner else ''}an admin may {action} it; you are "
        f"`{principal.name}`."
    )
    raise Forbidden(detail)


SHARE_HEADER = "Microcosmos-Share"
"""The header that names a share. Answers vary by it, so caches keep them apart."""


class ShareAccess(Protocol):
    """Read access to what a share shows. The package `shares` implements it."""

    @property
    def listed(self) -> bool:
        """Search engines may list the share's page."""
        ...

    def run(self, session: Session, run_id: UUID) -> Run:
        """Return the run as shared; raise `DomainError` if the share does not hold it."""
        ...

    def refuse_unless_holds(self, session: Session, creature: str) -> None:
        """Raise `DomainError` if the share does not hold a creature."""

    def licensed(self, file: dict[str, Any]) -> dict[str, Any]:
        """Return a creature file under the licence of the share."""
        ...

    def archive(self, session: Session) -> Artifact | None:
        """Return the archive file as it was shared, if there is one."""
        ...


async def share_access(request: Request) -> ShareAccess | None:
    """Return the share that the request names, if it names one."""
    return request.state.share


ShareAccessDep = Annotated[ShareAccess | None, Depends(share_access)]
