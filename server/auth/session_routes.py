"""Signing in and out of the page: a token in a cookie, which scripts cannot read."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from ..core.openapi import described
from ..core.uploads import sent
from .authorize import Door, Shown
from .cookies import forget, remember
from .middleware import address
from .schemas import CallerRead, SignIn

BYTES = 1 << 12

router = APIRouter(prefix="/session", tags=["tokens"])


@router.post("", openapi_extra=described(SignIn.model_json_schema()))
def sign_in(
    asked: Annotated[SignIn, Depends(sent(SignIn, BYTES))], request: Request, response: Response
) -> CallerRead:
    """Keep a token in a cookie of this site; 401 where it is wrong."""
    door: Door = request.app.state.door
    caller = door.identify(Shown(asked.token, address(request)))
    remember(response, request, asked.token, caller.expires_at)
    return CallerRead(
        name=caller.name,
        scope=caller.scope,
        token=caller.token,
        expires_at=caller.expires_at,
        needed=door.services.settings.needs_token,
    )


@router.delete("", status_code=204)
async def sign_out(request: Request, response: Response) -> None:
    """Forget the cookie; the token stays good."""
    forget(response, request)
