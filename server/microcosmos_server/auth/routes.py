"""Routes of tokens and of the session."""

from datetime import datetime
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Request, Response
from pydantic import Field, StringConstraints

from ..core.json_body import json_route
from ..core.schemas import Moment, Wire
from ..services.services import ServicesDep, SessionDep
from ..tables import USE_DAYS
from . import tokens
from .authenticate import Authenticator
from .authorize import MAY_ADMINISTER, PUBLIC, Reader
from .device_use import device_seconds
from .middleware import address, delete_token, set_token
from .principal import Scope


class Quota(Wire):
    """Limits on the runs of a token; None: without limit."""

    max_queued: Annotated[int, Field(ge=0, le=1_000_000)] | None = None
    max_running: Annotated[int, Field(ge=0, le=10_000)] | None = None
    device_hours: Annotated[float, Field(ge=0.0, le=1e9)] | None = None
    """Hours of devices in 30 days. Runs that have begun go on; no further one starts."""


class TokenCreate(Quota):
    """Name, scope, end and quota of a new token."""

    name: tokens.Name
    scope: Scope
    expires_at: Moment | None = None
    """Without it the token never expires."""


class TokenRead(Quota):
    """A token without its secret."""

    id: UUID
    name: str
    prefix: str
    scope: Scope
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None
    """Accurate to five minutes."""
    used_hours: float = 0.0
    """Hours of devices that its runs have had in 30 days."""


class TokenCreated(TokenRead):
    secret: str
    """Only the answer to the request that creates the token contains it."""


class PrincipalRead(Wire):
    """The principal of the request."""

    name: str
    scope: Scope
    token: UUID | None
    """The id; None for the user of this machine and for the token of the environment."""
    expires_at: datetime | None
    needed: bool
    """This server needs a token."""


class SignIn(Wire):
    token: Annotated[
        str, StringConstraints(strip_whitespace=True, min_length=1, max_length=500)
    ]


BODY_BYTES = 1 << 12

router = APIRouter(tags=["tokens"], route_class=json_route(BODY_BYTES))


@router.get("/tokens/current")
async def read_current(services: ServicesDep, principal: Reader) -> PrincipalRead:
    """Return the principal of the request."""
    return PrincipalRead(**vars(principal), needed=services.settings.needs_token)


@router.get("/tokens", dependencies=[MAY_ADMINISTER])
def list_tokens(session: SessionDep) -> list[TokenRead]:
    """Return all tokens, revoked ones too, newest first, without their secrets."""
    used = device_seconds(session, USE_DAYS)
    read = [TokenRead.model_validate(token) for token in tokens.all_tokens(session)]
    return [one.model_copy(update={"used_hours": used.get(one.id, 0.0) / 3600}) for one in read]


@router.post("/tokens", status_code=201, dependencies=[MAY_ADMINISTER])
def create_token(asked: TokenCreate, services: ServicesDep) -> TokenCreated:
    """Create a token. Only this answer contains its secret."""
    created = tokens.create(services, **asked.model_dump())
    read = TokenRead.model_validate(created.token)
    return TokenCreated(**read.model_dump(), secret=created.secret)


@router.patch("/tokens/{token_id}", dependencies=[MAY_ADMINISTER])
def change_token(token_id: UUID, asked: Quota, services: ServicesDep) -> TokenRead:
    """Change the quota of a token; omitted limits stay as they are."""
    quota = asked.model_dump(exclude_unset=True)
    return TokenRead.model_validate(tokens.change_quota(services, token_id, quota))


@router.delete("/tokens/{token_id}", dependencies=[MAY_ADMINISTER])
def revoke_token(token_id: UUID, services: ServicesDep) -> TokenRead:
    """End a token now, and the event streams that were opened with it."""
    return TokenRead.model_validate(tokens.revoke(services, token_id))


@router.post("/session", dependencies=[PUBLIC])
def sign_in(asked: SignIn, request: Request, response: Response) -> PrincipalRead:
    """Keep a token in a cookie of this site, which scripts cannot read; 401 if it is wrong."""
    authenticator: Authenticator = request.app.state.authenticator
    try:
        principal = authenticator.identify(asked.token)
    except tokens.UnknownToken as error:
        raise authenticator.reject(error, address(request)) from None
    # A cookie, since browsers open event streams without an Authorization header.
    set_token(response, request, asked.token, principal.expires_at)
    needed = authenticator.services.settings.needs_token
    return PrincipalRead(**vars(principal), needed=needed)


@router.delete("/session", status_code=204, dependencies=[PUBLIC])
async def sign_out(request: Request, response: Response) -> None:
    """Forget the cookie. The token stays valid."""
    delete_token(response, request)
