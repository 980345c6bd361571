"""What strangers may see without a token, and how carefully it is answered."""

import re

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

PUBLIC = re.compile(r"/api/v1/(shares/[^/]+(/.*)?|commons)")
SHARED = re.compile(r"(/s/|/api/v1/shares/).+")


def public(method: str, path: str) -> bool:
    """Whether a part of the API answers everybody; the page itself does anyway."""
    return method in ("GET", "HEAD") and PUBLIC.fullmatch(path) is not None


class Discretion:
    """Has addresses that were told in confidence stay with those who were told them.

    Nothing is kept without asking again, so that what is revoked is gone at once.
    """

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        shared = scope["type"] == "http" and SHARED.fullmatch(scope["path"])

        async def discreetly(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers["Cache-Control"] = "no-cache"
                headers["Referrer-Policy"] = "no-referrer"
                if not scope.get("state", {}).get("listed"):
                    headers["X-Robots-Tag"] = "noindex"
            await send(message)

        await self.app(scope, receive, discreetly if shared else send)
