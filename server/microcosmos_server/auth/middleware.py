"""Identify the principal of each request, and refuse requests from pages of other sites."""

from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from urllib.parse import SplitResult, urlsplit

from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import OperationalError, TimeoutError
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from ..core.errors import DomainError, Forbidden, problem_response
from ..core.security_headers import SHARED_FILES
from ..settings import LOOPBACK
from .authenticate import Authenticator
from .authorize import SHARE_HEADER, ShareAccess
from .principal import SHARE_HOLDER

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
        # Private networks have no HTTPS, and without it no browser sends a secure cookie.
        secure=request.url.scheme == "https",
    )


def delete_token(response: Response, request: HTTPConnection) -> None:
    response.delete_cookie(cookie_name(request), httponly=True, samesite="strict")


SAFE = ("GET", "HEAD")
METRICS = "/metrics"
"""A route outside `/api` that needs a token."""
SESSION = "/api/v1/session"
"""Signing in and out is the only change that needs no token."""


class PrincipalMiddleware:
    """Sets `request.state.principal`, or None with `request.state.refuse` for the reason.

    Without tokens, Host and Origin must be the server's own. That keeps out pages of other
    sites, also those whose name resolves to this machine. They may read files of shares.
    """

    def __init__(
        self,
        app: ASGIApp,
        authenticator: Authenticator,
        open_share: Callable[[str], ShareAccess],
    ):
        self.app, self.authenticator, self.open_share = app, authenticator, open_share
        self.needs_token = authenticator.services.settings.needs_token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        app = self.app
        if scope["type"] == "http":
            try:
                app = await self._identified(HTTPConnection(scope)) or self.app
            except (DomainError, OperationalError, TimeoutError) as error:
                app = problem_response(error)
        await app(scope, receive, send)

    async def _identified(self, request: HTTPConnection) -> Response | None:
        """Set the principal; return a response if the application must not respond itself."""
        if not self.needs_token:
            _refuse_foreign_host(request.headers)
        path, method = request.scope["path"], request.scope["method"]
        public = method in SAFE and SHARED_FILES.fullmatch(path)
        if not self.needs_token and not public:
            _refuse_foreign_origin(request.headers)
        request.state.principal = request.state.share = None
        if not path.startswith("/api/") and path != METRICS:
            return await self._page(request)
        if slug := request.headers.get(SHARE_HEADER):
            request.state.share = await run_in_threadpool(self.open_share, slug)
            request.state.principal = SHARE_HOLDER
            if method not in SAFE:  # Before the body is read.
                raise Forbidden(f"The holder of a share may only read, not {method}.")
            return None
        bearer = _bearer(request.headers)
        if self.needs_token and bearer is None and method not in SAFE:
            # A browser sends cookies by itself, also for a page of another site.
            _refuse_foreign_origin(request.headers)
        cookie = request.cookies.get(cookie_name(request)) if self.needs_token else None
        token = cookie if bearer is None else bearer
        try:
            identify = self.authenticator.identify
            request.state.principal = await run_in_threadpool(identify, token)
        except DomainError as error:
            # Public routes never call it, so they count no wrong token.
            request.state.refuse = partial(self.authenticator.reject, error, address(request))
            if method not in SAFE and path != SESSION:  # Before the body is read.
                raise request.state.refuse() from None
        return None

    async def _page(self, request: HTTPConnection) -> Response | None:
        """Move a token in the address of a page into a cookie. The page itself is public.

        Links of other sites sign nobody in: else their authors would see what is submitted.
        """
        given = request.query_params.get("token")
        if given is None or not self.needs_token:
            return None
        clean = request.url.remove_query_params("token")
        # The log of requests is written at the end: it must not name the secret.
        request.scope["query_string"] = clean.query.encode()
        if not _opened_by_a_person(request.headers):
            return RedirectResponse(clean, 303)  # The page asks for a token.
        try:
            principal = await run_in_threadpool(self.authenticator.identify, given)
        except DomainError as error:
            self.authenticator.reject(error, address(request))
            return None  # The page asks for a token.
        redirect = RedirectResponse(clean, 303)
        set_token(redirect, request, given, principal.expires_at)
        return redirect


def address(request: HTTPConnection) -> str:
    return request.client.host if request.client else ""


def _bearer(headers: Headers) -> str | None:
    """Return the token of the header, empty if it is malformed, None without the header."""
    sent = headers.get("authorization")
    if sent is None:
        return None
    scheme, _, token = sent.partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


def _refuse_foreign_host(headers: Headers) -> None:
    host = headers.get("host", "")
    if _split(f"//{host}").hostname not in LOOPBACK:
        needed = f"Host must be one of {', '.join(LOOPBACK)}; got {host!r}."
        raise Forbidden(needed)


def _refuse_foreign_origin(headers: Headers) -> None:
    origin = headers.get("origin")
    if origin is not None and _split(origin).netloc != headers.get("host", ""):
        needed = f"Origin must be this server's own page; got {origin!r}."
        raise Forbidden(needed)


def _opened_by_a_person(headers: Headers) -> bool:
    """Return whether a person opened the address, or a page of this server links to it.

    Over plain HTTP beyond loopback, browsers send no `Sec-Fetch-Site`: only links count then.
    """
    site, referer = headers.get("sec-fetch-site"), headers.get("referer")
    if site is None:
        return referer is not None and _split(referer).netloc == headers.get("host", "")
    return site in ("none", "same-origin")


def _split(address: str) -> SplitResult:
    """Return the parts of an address, all empty if it is malformed."""
    try:
        return urlsplit(address)
    except ValueError:
        return urlsplit("")
