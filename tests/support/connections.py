"""Requests that hold a connection to the database for longer than they need it.

As many requests at a time as a pool has connections wait for each other until all give up, if
each takes a second one; and while the store of files is slow, they leave none to anybody, if
each holds one until its file has come.
"""

import traceback
from contextvars import ContextVar
from functools import partial
from typing import Any

from sqlalchemy import Engine, event

from microcosmos_server.storage.artifacts import Artifacts

REQUEST: ContextVar[object | None] = ContextVar("REQUEST", default=None)
"""The request that is being answered; threads that answer it see it too."""


class Greedy:
    """Finds, and says where, requests take a second connection, or hold one during I/O."""

    def __init__(self) -> None:
        self.found: list[str] = []
        self._held: dict[Any, object | None] = {}

    def watch(self, engine: Engine) -> None:
        event.listen(engine, "checkout", self._taken)
        event.listen(engine, "checkin", self._returned)

    def watch_store(self, artifacts: Artifacts) -> None:
        for name in ("read", "write", "sizes"):
            setattr(artifacts, name, partial(self._alone, artifacts, name))

    def _alone(self, artifacts: Artifacts, name: str, *arguments: Any, **named: Any) -> Any:
        self._refuse_holder("holds a connection while it waits for the store")
        # Tests replace methods of the class.
        return getattr(type(artifacts), name)(artifacts, *arguments, **named)

    def _refuse_holder(self, what: str) -> None:
        request = REQUEST.get()
        if request is not None and request in list(self._held.values()):
            stack = "".join(traceback.format_stack(limit=25))
            self.found.append(f"{request} {what}\n{stack}")

    def _taken(self, _connection: Any, record: Any, _proxy: Any) -> None:
        self._refuse_holder("takes a second connection")
        self._held[record] = REQUEST.get()

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
