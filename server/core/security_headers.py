"""How carefully answers are given: to strangers, and to the pages of other sites."""

import re

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

SHARED = re.compile(r"(/s/|/api/v1/shares/).+")
PAGE = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
)
"""What a page of ours may load and run, and that no other page may hold it in a frame: where no
token is needed, its visitors could be made to click on what they do not see."""


class Discretion:
    """Says what browsers may do with an answer.

    Addresses that were told in confidence stay with those who were told them; nothing of what
    was shared is kept without asking again, so that what is revoked is gone at once. What was
    not shared is of no use to other sites, not even as a picture that loads or does not.
    """

    def __init__(self, app: ASGIApp, share_header: str):
        self.app, self.header = app, share_header

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        path, named = scope["path"], Headers(scope=scope).get(self.header) is not None
        shared = named or SHARED.fullmatch(path) is not None

        async def discreetly(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.setdefault("Content-Security-Policy", PAGE)
                headers["X-Content-Type-Options"] = "nosniff"
                headers["Cross-Origin-Resource-Policy"] = (
                    "cross-origin" if shared else "same-origin"
                )
                if path.startswith("/api/"):
                    headers.add_vary_header(self.header)
                if shared:
                    _confide(headers, _listed(scope))
            await send(message)

        await self.app(scope, receive, discreetly)


def _listed(scope: Scope) -> bool:
    """Return whether the share of a request is listed for everybody."""
    state = scope.get("state", {})
    return state.get("listed", False) or getattr(state.get("share"), "listed", False)


def _confide(headers: MutableHeaders, listed: bool) -> None:
    headers["Cache-Control"] = "no-cache"
    headers["Referrer-Policy"] = "no-referrer"
    if not listed:
        headers["X-Robots-Tag"] = "noindex"
