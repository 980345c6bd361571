"""The router of the API: its OpenAPI document, and answers to paths that do not exist."""

from typing import Any

from fastapi import APIRouter, FastAPI, Request
from fastapi.responses import JSONResponse, Response
from fastapi.routing import iter_route_contexts
from starlette.routing import compile_path

from .errors import MEDIA_TYPE, Problem, ProblemError

Answers = dict[int | str, dict[str, Any]]
PROBLEMS: Answers = {"default": {"model": Problem, "description": "A problem (RFC 9457)"}}
METHODS = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE"]

fallback = APIRouter(include_in_schema=False)
"""Routes after all others: the OpenAPI document, which needs a token too, and 404 or 405."""


def sends(media_type: str, others: Answers | None = None) -> dict[str, Any]:
    """Return the arguments of a route that sends a file, for the OpenAPI document."""
    responses = {200: {"content": {media_type: {}}}, **(others or {})}
    return {"response_class": Response, "responses": responses}


@fallback.get("/openapi.json")
def read_openapi(request: Request) -> JSONResponse:
    return JSONResponse(request.app.openapi())


@fallback.api_route("/{rest:path}", methods=METHODS)
async def refuse_path(request: Request) -> None:
    """Raise `ProblemError`: 404, or 405 with the methods that the path has."""
    path, method = request.scope["path"], request.method
    methods = {
        method
        for route in iter_route_contexts(request.app.routes)
        if route.name != "refuse_path" and route.path and route.path.startswith("/api/")
        if compile_path(route.path)[0].match(path)
        for method in route.methods or ()
    }
    if not methods:
        raise ProblemError(404, "Not found", f"There is nothing at {path:.200}.")
    allowed = ", ".join(sorted(methods))
    detail = f"{path:.200} takes {allowed}; got {method}."
    raise ProblemError(405, "Method not allowed", detail, headers={"Allow": allowed})


def describe(app: FastAPI) -> None:
    """Have the OpenAPI document give errors the media type of problems, not plain JSON."""
    generate = app.openapi

    def openapi() -> dict[str, Any]:
        document = generate()
        for operations in document["paths"].values():
            for operation in operations.values():
                error = operation["responses"].get("default")
                if error and MEDIA_TYPE not in error["content"]:
                    _, content = error["content"].popitem()
                    error["content"][MEDIA_TYPE] = content
        return document

    app.openapi = openapi
