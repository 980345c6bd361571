"""The cookie of the page: an event stream cannot be asked for with an Authorization header."""

from datetime import UTC, datetime

from starlette.responses import Response

COOKIE = "microcosmos_token"
DAYS = 90
"""For how long a browser keeps it, unless its token expires before."""


def remember(
    response: Response, token: str, scheme: str, expires_at: datetime | None = None
) -> None:
    """Keep a token out of reach of scripts, and of requests that other sites cause."""
    left = (expires_at - datetime.now(UTC)).total_seconds() if expires_at else DAYS * 86_400
    response.set_cookie(
        COOKIE,
        token,
        max_age=max(0, min(int(left), DAYS * 86_400)),
        httponly=True,
        samesite="strict",
        secure=scheme == "https",
    )


def forget(response: Response) -> None:
    response.delete_cookie(COOKIE, httponly=True, samesite="strict")
