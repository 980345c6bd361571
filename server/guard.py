"""Who may speak to the server: this machine's pages, or whoever has the token."""

from hmac import compare_digest
from urllib.parse import SplitResult, urlsplit

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from .open import public
from .problems import answer
from .schemas import Problem
from .settings import LOOPBACK

COOKIE = "microcosmos_token"
"""For pages: an event stream cannot be asked for with an Authorization header."""


class Guard:
    """With a token, `/api` needs it. Without one, Host and Origin must be this machine's own.

    The latter keeps out pages of other sites, also those that have their name resolve to us.
    """

    def __init__(self, app: ASGIApp, token: str | None):
        self.app, self.token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        instead = self._instead(HTTPConnection(scope)) if scope["type"] == "http" else None
        await (instead or self.app)(scope, receive, send)

    def _instead(self, request: HTTPConnection) -> Response | None:
        """What is answered in place of the application, if anything."""
        if self.token and self._shown(request):
            return _remember(request)
        problem = self._unknown(request) if self.token else self._foreign(request.headers)
        return answer(problem) if problem else None

    def _foreign(self, headers: Headers) -> Problem | None:
        host, origin = headers.get("host", ""), headers.get("origin")
        if _split(f"//{host}").hostname not in LOOPBACK:
            needed = f"Host must be one of {', '.join(LOOPBACK)}; got {host!r}."
            return Problem(title="Forbidden", status=403, detail=needed)
        if origin is not None and _split(origin).netloc != host:
            needed = f"Origin must be this server's own page; got {origin!r}."
            return Problem(title="Forbidden", status=403, detail=needed)
        return None

    def _unknown(self, request: HTTPConnection) -> Problem | None:
        path = request.url.path
        if not path.startswith("/api/") or public(request.scope["method"], path):
            return None
        scheme, _, sent = request.headers.get("authorization", "").partition(" ")
        given = sent if scheme.lower() == "bearer" else request.cookies.get(COOKIE, "")
        if self._right(given):
            return None
        needed = f"A token is needed, as `Authorization: Bearer` or cookie `{COOKIE}`."
        return Problem(title="Unauthorized", status=401, detail=needed)

    def _shown(self, request: HTTPConnection) -> bool:
        """Whether the token is in the address, with which a person opens the page first."""
        page = not request.url.path.startswith("/api/")
        return page and self._right(request.query_params.get("token", ""))

    def _right(self, given: str) -> bool:
        return compare_digest(given.encode(), (self.token or "").encode())


def _remember(request: HTTPConnection) -> Response:
    """Keep the token in a cookie of this site, and take it out of the address."""
    clean = request.url.remove_query_params("token")
    answer = RedirectResponse(clean, 303)
    token = request.query_params["token"]
    secure = request.url.scheme == "https"
    answer.set_cookie(COOKIE, token, httponly=True, samesite="strict", secure=secure)
    return answer


def _split(address: str) -> SplitResult:
    """The parts of an address; none where it is malformed."""
    try:
        return urlsplit(address)
    except ValueError:
        return urlsplit("")
