"""Security headers, and redaction of the request log."""

import logging
import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

SHARE_PATH = re.compile(r"(/s/|/api/v1/shares/).+")
SHARED_FILES = re.compile(r"/api/v1/shares/[^/]+/creatures?\.json")
"""The answers that scripts of any page may read: who asks must know the share's slug."""
# No other site may show the page in a frame: without tokens, it could trick visitors into
# clicking on hidden buttons. WebAssembly is allowed: the page verifies creatures by it.
POLICY = (
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; img-src 'self' data: blob:; "
    "style-src 'self' 'unsafe-inline'; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'none'"
)
SLUG = re.compile(r"(?<=/s/)[^/]+|(?<=/shares/)[^/]+")
SLUG_PREVIEW = 4
"""Characters of a slug in the log, to recognise requests for the same share."""


class SecurityHeaders:
    """Middleware: tell browsers what they may do with an answer.

    The address of a share is a secret, so it is sent to no other site. Answers of the API and
    about a share are revalidated each time, so that revoking a token or a share takes effect
    at once; shared caches, which know no tokens, keep none. Answers that are no share's cannot
    be embedded by other sites, not even as pictures.
    """

    def __init__(self, app: ASGIApp, share_header: str):
        self.app, self.header = app, share_header

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        path, named = scope["path"], Headers(scope=scope).get(self.header) is not None
        shared = named or SHARE_PATH.fullmatch(path) is not None

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("Content-Security-Policy", POLICY)
                headers["X-Content-Type-Options"] = "nosniff"
                headers["Cross-Origin-Resource-Policy"] = (
                    "cross-origin" if shared else "same-origin"
                )
                if SHARED_FILES.fullmatch(path):
                    headers["Access-Control-Allow-Origin"] = "*"
                if path.startswith("/api/"):
                    headers.add_vary_header(self.header)
                if shared or path.startswith("/api/"):
                    headers["Cache-Control"] = "private, no-cache"
                if shared:
                    headers["Referrer-Policy"] = "no-referrer"
                    state = scope.get("state", {})
                    access = state.get("share")
                    if not (state.get("listed") or getattr(access, "listed", False)):
                        headers["X-Robots-Tag"] = "noindex"
            await send(message)

        await self.app(scope, receive, send_with_headers)


def redact_request_log() -> None:
    """Have uvicorn log requests without query parameters and without the slugs of shares."""
    logging.getLogger("uvicorn.access").addFilter(_redact)


def _redact(record: logging.LogRecord) -> bool:
    # uvicorn gives the parts of a line as arguments; the path is one of them.
    if isinstance(record.args, tuple):
        record.args = tuple(
            SLUG.sub(lambda slug: f"{slug[0][:SLUG_PREVIEW]}…", one.partition("?")[0])
            if isinstance(one, str)
            else one
            for one in record.args
        )
    return True
