"""Requests that hold two connections to the database at once.

As many of them at a time as a pool has connections wait for each other until all give up.
"""

import traceback
from contextvars import ContextVar
from typing import Any

from sqlalchemy import Engine, event

REQUEST: ContextVar[object | None] = ContextVar("REQUEST", default=None)
"""The request that is being answered; threads that answer it see it too."""


class Greedy:
    """Finds, and says where, requests take a second connection from an engine's pool."""

    def __init__(self) -> None:
        self.found: list[str] = []
        self._held: dict[Any, object | None] = {}

    def watch(self, engine: Engine) -> None:
        event.listen(engine, "checkout", self._taken)
        event.listen(engine, "checkin", self._returned)

    def _taken(self, _connection: Any, record: Any, _proxy: Any) -> None:
        request = REQUEST.get()
        if request is not None and request in list(self._held.values()):
            self.found.append(f"{request}\n{''.join(traceback.format_stack(limit=25))}")
        self._held[record] = request

    def _returned(self, _connection: Any, record: Any) -> None:
        self._held.pop(record, None)


class Marked:
    """An application that marks each request for `Greedy`."""

    def __init__(self, app: Any):
        self.app = app

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "http":
            REQUEST.set(Request(f"{scope['method']} {scope['path']}"))
        await self.app(scope, receive, send)


class Request:
    """One request, equal to itself alone."""

    def __init__(self, name: str):
        self.name = name

    def __str__(self) -> str:
        return self.name
