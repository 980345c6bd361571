"""The router of the API: its OpenAPI document, and answers to paths that do not exist."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from fastapi import APIRouter, FastAPI, Request
from fastapi.responses import JSONResponse, Response
from fastapi.routing import iter_route_contexts
from starlette.datastructures import Headers, MutableHeaders
from starlette.routing import compile_path
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .errors import (
    MEDIA_TYPE,
    BadRequest,
    NotFound,
    Problem,
    method_not_allowed,
    problem_response,
)

Answers = dict[int | str, dict[str, Any]]
PROBLEMS: Answers = {"default": {"model": Problem, "description": "A problem (RFC 9457)"}}
METHODS = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE"]

fallback = APIRouter(include_in_schema=False)
"""Routes after all others: the OpenAPI document, which needs a token too, and 404 or 405."""


BYTES = "application/octet-stream"


def sends(media_type: str, others: Answers | None = None) -> dict[str, Any]:
    """Return the arguments of a route that sends a file, for the OpenAPI document.

    What is no text is offered as plain bytes too, see `AsBytes`.
    """
    text: dict[str, Any] = {"schema": {"type": "string"}}
    binary = {"schema": {"type": "string", "format": "binary"}}
    is_text = media_type.startswith("text/")
    content = {media_type: text} if is_text else {media_type: binary, BYTES: binary}
    responses = {200: {"content": content}, **(others or {})}
    return {"response_class": Response, "responses": responses}


class AsBytes:
    """Sends files as `application/octet-stream` to clients that accept that alone.

    Generators of clients know few media types, and leave out routes that offer none of them.
    """

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        asked = scope["type"] == "http" and Headers(scope=scope).get("accept") == BYTES

        async def start(message: Message) -> None:
            if message["type"] == "http.response.start" and message["status"] == 200:
                headers = MutableHeaders(scope=message)
                if "json" not in (headers.get("content-type") or "json"):
                    headers["content-type"] = BYTES
                    headers.add_vary_header("Accept")
            await send(message)

        await self.app(scope, receive, start if asked else send)


class HTTPRules:
    """Answers HEAD as GET, without the content (RFC 9110, 9.3.2), and refuses two lengths.

    A request with Content-Length and Transfer-Encoding may hide another one behind it
    (RFC 9112, 6.1): its connection is closed.
    """

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        headers = Headers(scope=scope) if scope["type"] == "http" else {}
        if "content-length" in headers and "transfer-encoding" in headers:
            detail = "One of Content-Length and Transfer-Encoding is needed; got both."
            refusal = problem_response(BadRequest(detail, headers={"Connection": "close"}))
            await refusal(scope, receive, send)
            return
        if scope["type"] != "http" or scope["method"] != "HEAD":
            await self.app(scope, receive, send)
            return
        begun = asyncio.Event()

        async def start(message: Message) -> None:
            if not begun.is_set():
                await send(message)
                await send({"type": "http.response.body", "body": b""})
                begun.set()

        answer = asyncio.ensure_future(self.app({**scope, "method": "GET"}, receive, start))
        waiting = asyncio.create_task(begun.wait())
        await asyncio.wait((answer, waiting), return_when=asyncio.FIRST_COMPLETED)
        waiting.cancel()
        if begun.is_set():  # Nobody needs the content, which may be long, or have no end.
            answer.cancel()
        with suppress(asyncio.CancelledError):
            await answer


def named(name: str, disposition: str = "attachment") -> dict[str, str]:
    """Return the header with the name under which a browser saves an answer."""
    return {"Content-Disposition": f'{disposition}; filename="{name}"'}


@fallback.get("/openapi.json")
def read_openapi(request: Request) -> JSONResponse:
    return JSONResponse(request.app.openapi())


@fallback.api_route("/{rest:path}", methods=METHODS)
async def refuse_path(request: Request) -> None:
    """Raise `DomainError`: 404, or 405 with the methods that the path has."""
    # This route matches every path, so Starlette itself never answers 405.
    path, method = request.scope["path"], request.method
    methods = {
        method
        for route in iter_route_contexts(request.app.routes)
        if route.name != "refuse_path" and route.path and route.path.startswith("/api/")
        if compile_path(route.path)[0].match(path)
        for method in route.methods or ()
    }
    if not methods:
        raise NotFound(f"There is nothing at {path:.200}.")
    raise method_not_allowed(path, method, methods)


def describe(app: FastAPI, *more: Callable[[dict[str, Any]], None]) -> None:
    """Have the OpenAPI document give errors the media type of problems, not plain JSON.

    `more` change the document further.
    """
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        document = generate()
        # FastAPI describes the models of errors with the media type of the route's own answer.
        for operations in document["paths"].values():
            for operation in operations.values():
                error = operation["responses"].get("default")
                if error and MEDIA_TYPE not in error["content"]:
                    _, content = error["content"].popitem()
                    error["content"][MEDIA_TYPE] = content
        for change in more:
            change(document)
        return document

    app.openapi = openapi
