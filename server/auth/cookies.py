"""The cookie of the page: an event stream cannot be asked for with an Authorization header."""

from datetime import UTC, datetime

from starlette.requests import HTTPConnection
from starlette.responses import Response

COOKIE = "microcosmos_token"
DAYS = 90
"""For how long a browser keeps it, unless its token expires before."""


def name(asked: HTTPConnection) -> str:
    """Browsers keep the cookies of all ports of a host together: two servers need two names.

    The port is the one that the browser knows, which `ssh -L` may have made another.
    """
    return f"{COOKIE}_{asked.url.port}" if asked.url.port else COOKIE


def remembered(asked: HTTPConnection) -> str | None:
    """The token that a browser keeps for us."""
    return asked.cookies.get(name(asked))


def remember(
    response: Response, asked: HTTPConnection, token: str, expires_at: datetime | None
) -> None:
    """Keep a token out of reach of scripts, and of requests that other sites cause."""
    left = (expires_at - datetime.now(UTC)).total_seconds() if expires_at else DAYS * 86_400
    response.set_cookie(
        name(asked),
        token,
        max_age=max(0, min(int(left), DAYS * 86_400)),
        httponly=True,
        samesite="strict",
        secure=asked.url.scheme == "https",
    )


def forget(response: Response, asked: HTTPConnection) -> None:
    response.delete_cookie(name(asked), httponly=True, samesite="strict")
