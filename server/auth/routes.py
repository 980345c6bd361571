"""Tokens: who asks; make, list and revoke them. Only admins come to the latter."""

from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends

from ..core.openapi import described
from ..core.uploads import sent
from ..services.deps import ServicesDep, SessionDep
from . import tokens
from .principal import PrincipalDep
from .schemas import CallerRead, TokenCreate, TokenMade, TokenRead

BYTES = 1 << 12

router = APIRouter(prefix="/tokens", tags=["tokens"])


@router.get("/current")
async def read_current(services: ServicesDep, caller: PrincipalDep) -> CallerRead:
    """Who asks, as the server has it."""
    return CallerRead(
        name=caller.name,
        scope=caller.scope,
        token=caller.token,
        expires_at=caller.expires_at,
        needed=services.settings.needs_token,
    )


@router.get("")
def list_tokens(session: SessionDep) -> list[TokenRead]:
    """All of them, those that were revoked too, newest first; never a secret."""
    return [TokenRead.model_validate(token) for token in tokens.known(session)]


@router.post("", status_code=201, openapi_extra=described(TokenCreate.model_json_schema()))
def create_token(
    asked: Annotated[TokenCreate, Depends(sent(TokenCreate, BYTES))], services: ServicesDep
) -> TokenMade:
    """Make a token. Its secret is in this answer and nowhere else."""
    made = tokens.create(services, asked.name, asked.scope, asked.expires_at)
    read = TokenRead.model_validate(made.token)
    return TokenMade(**read.model_dump(), secret=made.secret)


@router.delete("/{token_id}")
def revoke_token(token_id: UUID, services: ServicesDep) -> TokenRead:
    """End a token now, and the event streams that were opened with it."""
    return TokenRead.model_validate(tokens.revoke(services, token_id))
