"""How carefully strangers are answered, who see without a token what was shared."""

import re

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

SHARED = re.compile(r"(/s/|/api/v1/shares/).+")


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
