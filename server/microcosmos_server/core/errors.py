"""Errors that packages raise, and their problem details (RFC 9457) with fields as data."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Self

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.routing import iter_route_contexts
from pydantic import BaseModel, ValidationError
from redis import RedisError
from sqlalchemy.exc import OperationalError, TimeoutError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request

from microcosmos import spec as specs
from microcosmos.invalid import InvalidField
from microcosmos.spec.creature import CreatureError

from . import logs
from .schemas import Wire

log = logging.getLogger(__name__)
MAX_ERRORS = 50
"""Limit on the errors in one answer: a document may have one for each of its values."""
RETRY_AFTER = {"Retry-After": "2"}
MEDIA_TYPE = "application/problem+json"


class StoreUnavailable(OSError):
    """The file store cannot be read or written now; its files may still be intact."""


class FileLost(FileNotFoundError):
    """The store lacks a file that the database names, or it has changed there."""


class FieldError(Wire):
    field: str
    """A dotted path, as in the request."""
    reason: str
    """The error of the value, without the name of the field."""
    needed: str | None = None
    got: Any = None
    least: float | None = None
    """The nearest number that the field accepts, above the wrong one."""
    most: float | None = None
    """The nearest number that the field accepts, below the wrong one."""

    @classmethod
    def of(cls, error: InvalidField) -> Self:
        got = None if error.needed is None else shortened(error.got)
        limits = {"least": error.least, "most": error.most}
        return cls(
            field=error.field, reason=error.reason, needed=error.needed, got=got, **limits
        )


class Problem(BaseModel):
    """RFC 9457."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldError] | None = None


class DomainError(Exception):
    """Base class of the errors that packages raise: a sentence, and the fields that are wrong.

    This module alone turns a kind of error into a status of HTTP.
    """

    status: ClassVar[int]
    title: ClassVar[str]

    def __init__(
        self,
        detail: str,
        errors: Sequence[FieldError] = (),
        *,
        title: str = "",
        headers: Mapping[str, str] | None = None,
    ):
        super().__init__(detail)
        self.detail, self.errors = detail, list(errors)
        self.name, self.headers = title or self.title, headers

    @property
    def problem(self) -> Problem:
        errors = self.errors or None
        return Problem(title=self.name, status=self.status, detail=self.detail, errors=errors)


class BadRequest(DomainError):
    """The request is not the HTTP that it should be."""

    status, title = 400, "Bad request"


class Unauthorized(DomainError):
    status, title = 401, "Unauthorized"


class Forbidden(DomainError):
    status, title = 403, "Forbidden"


class NotFound(DomainError):
    status, title = 404, "Not found"


class MethodNotAllowed(DomainError):
    status, title = 405, "Method not allowed"


class Conflict(DomainError):
    """The state of the object does not allow the request."""

    status, title = 409, "Conflict"


class Gone(DomainError):
    status, title = 410, "Gone"


class TooLarge(DomainError):
    status, title = 413, "Too large"


class RangeNotSatisfiable(DomainError):
    status, title = 416, "Range not satisfiable"


class Invalid(DomainError):
    """The request is wrong, whatever the state of the server."""

    status, title = 422, "Invalid input"


class TooMany(DomainError):
    status, title = 429, "Too many"


class Failed(DomainError):
    """The server or a worker could not do what a right request asked."""

    status, title = 500, "Internal server error"


class Unavailable(DomainError):
    status, title = 503, "Unavailable"


class Relayed(DomainError):
    """The error that another process found and sent as a problem."""

    def __init__(self, sent: Problem):
        super().__init__(sent.detail, sent.errors or (), title=sent.title)
        self.sent = sent

    @property
    def problem(self) -> Problem:
        return self.sent


HANDLED = (
    *(DomainError, ValidationError, RequestValidationError, CreatureError, HTTPException),
    ClientDisconnect,
    # Starlette calls the handler of `Exception` outside all middleware, and then raises the
    # error again for the log.
    *(OperationalError, TimeoutError, RedisError, StoreUnavailable, FileLost, Exception),
)


def install(app: FastAPI) -> None:
    def respond(request: Request, error: Exception) -> JSONResponse:
        return problem_response(_other_method(request, error) or error)

    for kind in HANDLED:
        app.add_exception_handler(kind, respond)


def _other_method(request: Request, error: Exception) -> MethodNotAllowed | None:
    """Return the error of `PATCH /runs/estimate`, which the route of a run with an id takes."""
    if not isinstance(error, RequestValidationError) or error.errors()[0]["loc"][0] != "path":
        return None
    path = request.scope["path"]
    methods = {
        method
        for route in iter_route_contexts(request.app.routes)
        if route.path == path
        for method in route.methods or ()
    }
    return method_not_allowed(path, request.method, methods) if methods else None


def method_not_allowed(path: str, method: str, methods: set[str]) -> MethodNotAllowed:
    allowed = ", ".join(sorted(methods | ({"HEAD"} if "GET" in methods else set())))
    detail = f"{path:.200} takes {allowed}; got {method}."
    return MethodNotAllowed(detail, headers={"Allow": allowed})


def problem_response(error: Exception) -> JSONResponse:
    problem = problem_of(error)
    retry = RETRY_AFTER if problem.status == 503 else None
    content = problem.model_dump(mode="json", exclude_none=True)
    headers = getattr(error, "headers", None) or retry
    return JSONResponse(content, problem.status, headers, media_type=MEDIA_TYPE)


def problem_of(error: Exception) -> Problem:
    match error:
        case DomainError():
            return error.problem
        case ValidationError():
            return _invalid(field_errors(error))
        case RequestValidationError():
            # The first part of a location is "query", "path" or "body".
            found = [{**one, "loc": one["loc"][1:]} for one in error.errors()]
            return _invalid(_fields(found))
        case CreatureError():
            return _invalid([FieldError.of(error)])
        case ClientDisconnect():
            return BadRequest("The connection ended before the whole request had come.").problem
        case HTTPException():
            return Problem(title=error.detail, status=error.status_code, detail=error.detail)
        case OperationalError() | TimeoutError() | RedisError() | StoreUnavailable():
            name = _service(error)
            log.error("%s did not answer: %s", name, error)
            detail = f"{name} does not answer; try again."
            return Problem(title="Unavailable", status=503, detail=detail)
        case FileLost():
            log.error("the store has lost %s", error)
            detail = f"The store has lost {error}; restore it from a backup."
            return Problem(title="File lost", status=500, detail=detail)
        case _:
            detail = f"The server failed; its log says why at request {logs.request_id()}."
            return Problem(title="Internal server error", status=500, detail=detail)


def _service(error: Exception) -> str:
    match error:
        case RedisError():
            return "Redis"
        case StoreUnavailable():
            return "The store of files"
        case _:
            return "The database"


def _invalid(errors: list[FieldError]) -> Problem:
    return invalid_fields(*errors).problem


def invalid_fields(*errors: FieldError) -> Invalid:
    return Invalid("; ".join(f"{one.field}: {one.reason}" for one in errors), errors)


def invalid_field(field: str, needed: str, got: Any) -> Invalid:
    got = shortened(got)
    reason = f"needs {needed}; got {got!r}"
    return invalid_fields(FieldError(field=field, reason=reason, needed=needed, got=got))


def field_errors(error: ValidationError) -> list[FieldError]:
    return _fields(error.errors(include_url=False))


def _fields(errors: Sequence[Mapping[str, Any]]) -> list[FieldError]:
    found = specs.invalid_fields(_without_redundant(errors[:MAX_ERRORS]))
    return [FieldError.of(one) for one in found]


def _without_redundant(errors: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Drop the error that a list is too short if one of its items has an error."""

    def redundant(error: Mapping[str, Any]) -> bool:
        place = error["loc"]
        inside = [e for e in errors if e is not error and e["loc"][: len(place)] == place]
        return error["type"] == "too_short" and bool(inside)

    return [error for error in errors if not redundant(error)]


def shortened(value: Any) -> Any:
    """Return a value that JSON can hold; shorten long texts."""
    if value is None or isinstance(value, bool | int | float):
        # JSON has no infinities and no NaN. Comparing NaN gives False.
        return value if abs(value or 0) < 1e308 else str(value)
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 120 else f"{text[:117]}..."


def first_line(error: Exception) -> str:
    """Return the class and the first line of the message of an exception."""
    name, message = type(error).__name__, str(error).partition("\n")[0]
    return f"{name}: {message}" if message else name
