"""Signing in and out of the page: a token in a cookie, which scripts cannot read."""

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool

from .. import access
from ..cookies import forget, remember
from ..deps import ServicesDep
from ..schemas import CallerRead, SignIn

router = APIRouter(prefix="/session", tags=["tokens"])


@router.post("")
async def sign_in(
    asked: SignIn, request: Request, response: Response, services: ServicesDep
) -> CallerRead:
    """Keep a token in a cookie of this site; 401 where it is wrong."""
    caller = await run_in_threadpool(access.identify, services, asked.token)
    remember(response, asked.token, request.url.scheme, caller.expires_at)
    return CallerRead(
        name=caller.name,
        scope=caller.scope,
        token=caller.token,
        expires_at=caller.expires_at,
        needed=services.settings.needs_token,
    )


@router.delete("", status_code=204)
async def sign_out(response: Response) -> None:
    """Forget the cookie; the token stays good."""
    forget(response)
