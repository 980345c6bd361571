"""The cookie of the page: browsers open event streams without an Authorization header."""

from datetime import UTC, datetime

from starlette.requests import HTTPConnection
from starlette.responses import Response

COOKIE = "microcosmos_token"
DAYS = 90
"""Lifetime of the cookie, unless its token expires earlier."""


def cookie_name(request: HTTPConnection) -> str:
    """Return the name of the cookie; browsers share cookies among the ports of a host.

    The port is the one that the browser uses, which `ssh -L` may have changed.
    """
    return f"{COOKIE}_{request.url.port}" if request.url.port else COOKIE


def set_token(
    response: Response, request: HTTPConnection, token: str, expires_at: datetime | None
) -> None:
    """Set a cookie that neither scripts nor requests from other sites can use."""
    left = (expires_at - datetime.now(UTC)).total_seconds() if expires_at else DAYS * 86_400
    response.set_cookie(
        cookie_name(request),
        token,
        max_age=max(0, min(int(left), DAYS * 86_400)),
        httponly=True,
        samesite="strict",
        secure=request.url.scheme == "https",
    )


def delete_token(response: Response, request: HTTPConnection) -> None:
    response.delete_cookie(cookie_name(request), httponly=True, samesite="strict")
