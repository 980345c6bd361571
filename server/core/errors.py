"""Errors as problem details (RFC 9457): the field, the allowed values, the received value."""

import logging
import re
from collections.abc import Mapping, Sequence
from typing import Any, Self

from fastapi import FastAPI
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ValidationError
from redis import RedisError
from sqlalchemy.exc import OperationalError, TimeoutError
from starlette.exceptions import HTTPException

from microcosmos.spec import field_path
from microcosmos.spec.creature import CreatureError

from . import logs
from .schemas import Wire

log = logging.getLogger(__name__)
MAX_ERRORS = 50
"""Limit on the errors in one answer: a document may have one for each of its values."""
RETRY_AFTER = {"Retry-After": "2"}
MEDIA_TYPE = "application/problem+json"
FIELD_IN_MESSAGE = re.compile(r"`([a-z_0-9.]+)` (?:must|needs|was)")


class StoreUnavailable(OSError):
    """The store of files cannot be read or written now; what it holds is not in doubt."""


class FieldError(Wire):
    field: str
    message: str
    needed: str | None = None
    got: Any = None


class Problem(BaseModel):
    """RFC 9457."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldError] | None = None


class ProblemError(Exception):
    """Base class of the errors that packages raise. The API answers them as problems."""

    def __init__(
        self,
        status: int,
        title: str,
        detail: str,
        errors: list[FieldError] | None = None,
        headers: Mapping[str, str] | None = None,
    ):
        super().__init__(detail)
        self.problem = Problem(title=title, status=status, detail=detail, errors=errors)
        self.headers = headers

    @classmethod
    def of(cls, problem: Problem) -> Self:
        """Return the error of a problem that another process found."""
        return cls(problem.status, problem.title, problem.detail, problem.errors)


HANDLED = (
    *(ProblemError, ValidationError, RequestValidationError, CreatureError, HTTPException),
    *(OperationalError, TimeoutError, RedisError, StoreUnavailable, Exception),
)


def install(app: FastAPI) -> None:
    for kind in HANDLED:
        app.add_exception_handler(kind, lambda _, error: problem_response(error))


def problem_response(error: Exception) -> JSONResponse:
    problem = problem_of(error)
    retry = RETRY_AFTER if problem.status == 503 else None
    content = problem.model_dump(mode="json", exclude_none=True)
    headers = getattr(error, "headers", None) or retry
    return JSONResponse(content, problem.status, headers, media_type=MEDIA_TYPE)


def problem_of(error: Exception) -> Problem:
    match error:
        case ProblemError():
            return error.problem
        case ValidationError():
            return invalid_input(field_errors(error))
        case RequestValidationError():
            # The first part of a location is "query", "path" or "body".
            found = [{**one, "loc": one["loc"][1:]} for one in error.errors()]
            return invalid_input(_fields(found))
        case CreatureError():
            named = {"field": error.field, "needed": error.needed, "got": shortened(error.got)}
            return invalid_input([FieldError(message=str(error), **named)])
        case HTTPException():
            return Problem(title=error.detail, status=error.status_code, detail=error.detail)
        case OperationalError() | TimeoutError() | RedisError() | StoreUnavailable():
            name = _service(error)
            log.error("%s did not answer: %s", name, error)
            detail = f"{name} does not answer; try again."
            return Problem(title="Unavailable", status=503, detail=detail)
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


def invalid_fields(*errors: FieldError) -> ProblemError:
    return ProblemError.of(invalid_input(list(errors)))


def invalid_field(field: str, needed: str, got: Any) -> ProblemError:
    return invalid_fields(_needs(field, needed, shortened(got)))


def invalid_input(errors: list[FieldError]) -> Problem:
    detail = "; ".join(f"{error.field}: {error.message}" for error in errors)
    return Problem(title="Invalid input", status=422, detail=detail, errors=errors)


def field_errors(error: ValidationError) -> list[FieldError]:
    return _fields(error.errors(include_url=False))


def _fields(errors: Sequence[Mapping[str, Any]]) -> list[FieldError]:
    found = _without_redundant(errors[:MAX_ERRORS])
    return [_field_error(one, field_path(one["loc"])) for one in found]


def _without_redundant(errors: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Drop the error that a list is too short if one of its items has an error."""

    def redundant(error: Mapping[str, Any]) -> bool:
        place = error["loc"]
        inside = [e for e in errors if e is not error and e["loc"][: len(place)] == place]
        return error["type"] == "too_short" and bool(inside)

    return [error for error in errors if not redundant(error)]


def _field_error(error: Mapping[str, Any], path: str) -> FieldError:
    message = str(error["msg"]).removeprefix("Value error, ")
    if error["type"] == "value_error":  # Our own messages name the field and its value.
        named = FIELD_IN_MESSAGE.search(message)
        field = ".".join(filter(None, [path, named[1] if named else ""]))
        return FieldError(field=field, message=message)
    needed = message.removeprefix("Input should be ")
    if error["type"] == "extra_forbidden":
        needed = "no field of this name"
    got = shortened(error["input"])
    if error["type"] in ("uuid_parsing", "uuid_type"):
        needed = "an id such as 1b4e28ba-2fa1-41d2-883f-0016d3cca427"
    if error["type"] == "missing":
        needed, got = "a value", "nothing"
    return _needs(path, needed, got)


def _needs(field: str, needed: str, got: Any) -> FieldError:
    message = f"needs {needed}; got {got!r}"
    return FieldError(field=field, message=message, needed=needed, got=got)


def shortened(value: Any) -> Any:
    """Return a value that JSON can hold; shorten long texts."""
    if value is None or isinstance(value, bool | int | float):
        return value if abs(value or 0) < 1e308 else str(value)
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
