"""Who may speak to the server: this machine's pages, or whoever has a token."""

from urllib.parse import SplitResult, urlsplit

from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import SQLAlchemyError
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from ..core.errors import ProblemError, answer, unavailable
from ..settings import LOOPBACK
from .authorize import Door, Shown
from .cookies import remember, remembered
from .principal import ANONYMOUS, Principal
from .scopes import METRICS, Unnamed, need_of

SAFE = ("GET", "HEAD")


class Guard:
    """Where tokens are needed, `/api` needs them. Else Host and Origin must be our own.

    The latter keeps out pages of other sites, also those that have their name resolve to us.
    """

    def __init__(self, app: ASGIApp, door: Door):
        self.app, self.door = app, door
        self.needs_token = door.services.settings.needs_token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return None
        request = HTTPConnection(scope)
        try:
            caller = await self._admitted(request)
        except ProblemError as error:
            return await answer(error.problem, error.headers)(scope, receive, send)
        except SQLAlchemyError as error:
            return await unavailable(error)(scope, receive, send)
        if isinstance(caller, Response):
            return await caller(scope, receive, send)
        request.state.principal = caller
        return await self.app(scope, receive, send)

    async def _admitted(self, request: HTTPConnection) -> Principal | Response:
        """Whoever asks, or what is answered in place of the application."""
        if not self.needs_token:
            _refuse_foreign_host(request.headers)
            _refuse_foreign_origin(request.headers)
        path = request.scope["path"]
        if not path.startswith("/api/") and path != METRICS:
            return await self._page(request)
        bearer = _bearer(request.headers)
        if self.needs_token and bearer is None and request.scope["method"] not in SAFE:
            # A browser sends cookies by itself, whoever's page has it ask.
            _refuse_foreign_origin(request.headers)
        cookie = remembered(request) if self.needs_token else None
        shown = Shown(cookie if bearer is None else bearer, address(request))
        return await self._api(request.scope["method"], path, shown)

    async def _api(self, method: str, path: str, shown: Shown) -> Principal:
        try:
            need = need_of(method, path)
        except Unnamed as error:
            await run_in_threadpool(self.door.identify, shown)
            raise _nothing(method, path, error.methods) from None
        return await run_in_threadpool(self.door.admit, shown, need)

    async def _page(self, request: HTTPConnection) -> Principal | Response:
        """The page itself is for everybody; a token in its address is taken into a cookie."""
        given = request.query_params.get("token")
        everybody = ANONYMOUS
        if given is None or not self.needs_token:
            return everybody
        clean = request.url.remove_query_params("token")
        # The log of requests is written at the end: it must not name the secret.
        request.scope["query_string"] = clean.query.encode()
        try:
            shown = Shown(given, address(request))
            caller = await run_in_threadpool(self.door.identify, shown)
        except ProblemError:
            return everybody  # Its page asks for a token.
        redirect = RedirectResponse(clean, 303)
        remember(redirect, request, given, caller.expires_at)
        return redirect


def address(request: HTTPConnection) -> str:
    """Where a request comes from, as far as that is known."""
    return request.client.host if request.client else ""


def _bearer(headers: Headers) -> str | None:
    """The token in a header, empty where it is malformed; None without the header."""
    sent = headers.get("authorization")
    if sent is None:
        return None
    scheme, _, token = sent.partition(" ")
    return token.strip() if scheme.lower() == "bearer" else ""


def _nothing(method: str, path: str, methods: list[str]) -> ProblemError:
    if not methods:
        return ProblemError(404, "Not found", f"There is nothing at {path:.200}.")
    allowed = ", ".join(methods)
    detail = f"{path:.200} takes {allowed}; got {method}."
    return ProblemError(405, "Method not allowed", detail, headers={"Allow": allowed})


def _refuse_foreign_host(headers: Headers) -> None:
    host = headers.get("host", "")
    if _split(f"//{host}").hostname not in LOOPBACK:
        needed = f"Host must be one of {', '.join(LOOPBACK)}; got {host!r}."
        raise ProblemError(403, "Forbidden", needed)


def _refuse_foreign_origin(headers: Headers) -> None:
    origin = headers.get("origin")
    if origin is not None and _split(origin).netloc != headers.get("host", ""):
        needed = f"Origin must be this server's own page; got {origin!r}."
        raise ProblemError(403, "Forbidden", needed)


def _split(address: str) -> SplitResult:
    """The parts of an address; none where it is malformed."""
    try:
        return urlsplit(address)
    except ValueError:
        return urlsplit("")
