"""Read JSON bodies: limit their size, and refuse what is not plain JSON."""

import json
import math
import re
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from pydantic import TypeAdapter, ValidationError

from .errors import DomainError, Invalid, TooLarge

MAX_DEPTH = 32
MAX_VALUES = 100_000
"""Limit on commas: each value may cause an error. The largest creature has fewer."""
NUL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")
"""An escaped NUL whose backslash is not itself escaped."""


def json_route(limit: int) -> type[APIRoute]:
    """Return a class of routes that take JSON objects of at most `limit` bytes.

    FastAPI itself reads bodies of any length, and JSON that other parsers refuse.
    """

    class JSONRoute(APIRoute):
        def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
            handle = super().get_route_handler()
            if self.body_field is None:
                return handle
            strict = TypeAdapter[Any](self.body_field.field_info.annotation or Any)

            def checked(body: bytes) -> dict[str, Any]:
                document = mapping(parse(body))
                refuse_other_types(strict, body)
                return document

            async def read(request: Request) -> Response:
                body = await read_body(request, limit)
                # In a thread: the largest spec has a megabyte, and the event loop serves
                # others.
                document = await run_in_threadpool(checked, body)
                return await handle(_parsed(request, body, document))

            return read

    return JSONRoute


def refuse_other_types(model: TypeAdapter[Any], body: bytes) -> None:
    """Raise `RequestValidationError` for values of other types.

    FastAPI would take false for the number 0 and "5" for 5. It finds all other errors itself.
    """
    try:
        model.validate_json(body or b"{}", strict=True)
    except ValidationError as error:
        wrong = [one for one in error.errors() if _of_another_type(one)]
        if wrong:
            found = [{**one, "loc": ("body", *one["loc"])} for one in wrong]
            raise RequestValidationError(found) from None


def _of_another_type(error: Any) -> bool:
    whole = isinstance(error["input"], float) and error["input"].is_integer()
    return error["type"].endswith("_type") and not (whole and error["type"] == "int_type")


def _parsed(request: Request, body: bytes, document: dict[str, Any]) -> Request:
    """Return the request with its body as JSON, ignoring its content type."""
    headers = [one for one in request.scope["headers"] if one[0] != b"content-type"]
    headers.append((b"content-type", b"application/json"))
    parsed = Request({**request.scope, "headers": headers}, request.receive)
    # Starlette keeps there what it has read. Without them FastAPI would parse the body again,
    # by its own rules.
    parsed._body, parsed._json = body or b"{}", document
    return parsed


def mapping(document: Any) -> dict[str, Any]:
    """Return the document; raise `DomainError` unless it is a JSON object."""
    if not isinstance(document, dict):
        raise Invalid(f"A JSON object is needed; got {document!r:.80}.", title="Not an object")
    return document


async def read_body(request: Request, limit: int) -> bytes:
    """Return the body; raise `DomainError` as soon as it is longer than the limit."""
    body = bytearray()
    # A length that the client states may be absent or wrong
    # (tests/server/creatures/test_creatures.py streams one without).
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            detail = f"The body has more than the {limit:,} bytes that are allowed."
            raise TooLarge(detail)
    return bytes(body)


def parse(body: bytes) -> Any:
    """Return the document of a JSON text, or raise `DomainError`.

    NaN, infinities, repeated names, deep nesting, lone surrogates and NUL are errors.
    """
    if body.count(b",") > MAX_VALUES:
        detail = f"The body has more than the {MAX_VALUES:,} values that are allowed."
        raise TooLarge(detail)
    try:
        document = json.loads(
            body.decode(),  # JSON is UTF-8 without a byte order mark (RFC 8259).
            parse_constant=_refuse_constant,
            parse_float=_finite,
            object_pairs_hook=_distinct,
        )
    except RecursionError:
        raise _too_deep() from None
    except ValueError as error:  # Also bytes that are not UTF-8.
        raise Invalid(f"JSON is needed; {_place(error)}.", title="Not JSON") from error
    refuse_unstorable(document)
    return document


def _place(error: ValueError) -> str:
    """Return the place of the error, without the parser's words."""
    if isinstance(error, json.JSONDecodeError):
        if error.doc.startswith("\ufeff"):
            return "the body begins with a byte order mark (BOM)"
        return f"the body is not JSON at line {error.lineno}, column {error.colno}"
    if isinstance(error, UnicodeDecodeError):
        return f"the body is not UTF-8 at byte {error.start}"
    return "the body has a number of too many digits"


def refuse_unstorable(document: Any) -> None:
    """Raise `DomainError` for values that databases or other readers of JSON cannot hold."""
    _refuse_depth(document)
    # PostgreSQL refuses NUL and lone surrogates in texts, SQLite stores both.
    text = json.dumps(document, ensure_ascii=False)
    try:
        text.encode()
    except UnicodeEncodeError as error:
        found = ascii(text[error.start])
        raise Invalid(f"Text must be Unicode; got {found}.", title="Not Unicode") from None
    if NUL.search(text):
        raise Invalid("Text must be without NUL; got \\u0000.", title="Not text")


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse repeated names: JSON parsers disagree on which one counts."""
    found = dict(pairs)
    if len(found) < len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise Invalid(f"Names must differ; got {twice[:60]!r} twice.", title="Not JSON")
    return found


def _refuse_constant(name: str) -> None:
    raise Invalid(f"Numbers must be finite; got {name}.", title="Not JSON")


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        _refuse_constant(text)
    return value


def _refuse_depth(document: Any) -> None:
    # Level by level: a recursion would end at Python's own limit first.
    level = [document]
    for _ in range(MAX_DEPTH):
        level = [
            child
            for value in level
            if isinstance(value, dict | list)
            for child in (value.values() if isinstance(value, dict) else value)
        ]
        if not level:
            return
    raise _too_deep()


def _too_deep() -> DomainError:
    detail = f"The body nests more than the {MAX_DEPTH} levels that are allowed."
    return Invalid(detail, title="Nested too deeply")
