"""JSON that people send: limited while it streams, and refused where it is not plain JSON."""

import json
import math
from collections.abc import Awaitable, Callable
from typing import Any

from fastapi import Request

from .problems import Refused

DEPTH = 32


def json_object(limit: int) -> Callable[[Request], Awaitable[dict[str, Any]]]:
    """A dependency that reads the body as a JSON object of at most so many bytes."""

    async def read(request: Request) -> dict[str, Any]:
        document = parse(await _limited(request, limit))
        if not isinstance(document, dict):
            raise Refused(
                422, "Not an object", f"A JSON object is needed; got {document!r:.80}."
            )
        return document

    return read


async def _limited(request: Request, limit: int) -> bytes:
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise Refused(413, "Too large", f"At most {limit:,} bytes are taken; more came.")
    return bytes(body)


def parse(body: bytes) -> Any:
    """The document in some JSON; NaN, infinities and deep nesting are refused."""
    try:
        document = json.loads(body, parse_constant=_refuse_constant, parse_float=_finite)
    except RecursionError:
        raise _too_deep() from None
    except ValueError as error:  # Among them bytes that are no UTF-8.
        raise Refused(
            422, "Not JSON", f"JSON is needed; got something else: {error}."
        ) from error
    _refuse_depth(document)
    return document


def _refuse_constant(name: str) -> None:
    raise Refused(422, "Not JSON", f"Numbers must be finite; got {name}.")


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        _refuse_constant(text)
    return value


def _refuse_depth(document: Any) -> None:
    level = [document]
    for _ in range(DEPTH):
        level = [
            child
            for value in level
            if isinstance(value, dict | list)
            for child in (value.values() if isinstance(value, dict) else value)
        ]
        if not level:
            return
    raise _too_deep()


def _too_deep() -> Refused:
    return Refused(422, "Nested too deeply", f"At most {DEPTH} levels are taken; more came.")
