"""Answer requests of the API that no route takes: 404, or 405 with the methods that exist."""

from fastapi import APIRouter, Request
from fastapi.routing import iter_route_contexts
from starlette.routing import compile_path

from .errors import ProblemError

METHODS = ["GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE"]

router = APIRouter(include_in_schema=False)


@router.api_route("/{rest:path}", methods=METHODS)
async def nowhere(request: Request) -> None:
    path, method = request.scope["path"], request.method
    routes = [one for one in iter_route_contexts(request.app.routes) if one.name != "nowhere"]
    named = [one for one in routes if one.path and one.path.startswith("/api/")]
    matching = [one for one in named if compile_path(one.path or "")[0].match(path)]
    methods = sorted({method for one in matching for method in one.methods or ()})
    if not methods:
        raise ProblemError(404, "Not found", f"There is nothing at {path:.200}.")
    allowed = ", ".join(methods)
    detail = f"{path:.200} takes {allowed}; got {method}."
    raise ProblemError(405, "Method not allowed", detail, headers={"Allow": allowed})
