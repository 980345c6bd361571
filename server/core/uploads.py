"""JSON that people send: limited while it streams, and refused where it is not plain JSON."""

import json
import math
import re
from collections import Counter
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from pydantic import BaseModel

from .errors import ProblemError

Sent = TypeVar("Sent", bound=BaseModel)
DEPTH = 32
VALUES = 100_000
"""More than the largest creature has: each may become an error with words to it."""
NUL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")
"""As JSON is written: escaped, and the escape itself not escaped."""


def json_object(limit: int) -> Callable[[Request], Awaitable[dict[str, Any]]]:
    """A dependency that reads the body as a JSON object of at most so many bytes."""

    async def read(request: Request) -> dict[str, Any]:
        return mapping(await run_in_threadpool(parse, await limited(request, limit)))

    return read


def sent(model: type[Sent], limit: int) -> Callable[[Request], Awaitable[Sent]]:
    """A dependency that reads the body as a model, of at most so many bytes of JSON."""
    read_object = json_object(limit)

    async def read(request: Request) -> Sent:
        return model.model_validate(await read_object(request))

    return read


def mapping(document: Any) -> dict[str, Any]:
    """The document, if it is a JSON object."""
    if not isinstance(document, dict):
        raise ProblemError(
            422, "Not an object", f"A JSON object is needed; got {document!r:.80}."
        )
    return document


async def limited(request: Request, limit: int) -> bytes:
    """The body, if it is not longer than that; nothing more of it is read."""
    body = bytearray()
    async for chunk in request.stream():
        body += chunk
        if len(body) > limit:
            raise ProblemError(
                413, "Too large", f"At most {limit:,} bytes are taken; more came."
            )
    return bytes(body)


def parse(body: bytes) -> Any:
    """The document in some JSON; what cannot be kept or sent on is refused.

    That is NaN, infinities, a name twice, deep nesting, and text with lone surrogates or NUL.
    """
    if body.count(b",") > VALUES:
        raise ProblemError(413, "Too large", f"At most {VALUES:,} values are taken; more came.")
    try:
        document = json.loads(
            body.decode(),  # JSON between programs is UTF-8, without a mark that says so.
            parse_constant=_refuse_constant,
            parse_float=_finite,
            object_pairs_hook=_distinct,
        )
    except RecursionError:
        raise _too_deep() from None
    except ValueError as error:  # Among them bytes that are no UTF-8.
        raise ProblemError(
            422, "Not JSON", f"JSON is needed; got something else: {error}."
        ) from error
    refuse_unkeepable(document)
    return document


def refuse_unkeepable(document: Any) -> None:
    """Raise `ProblemError` for what databases and other readers of JSON may stumble over."""
    _refuse_depth(document)
    _refuse_text(document)


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Readers of JSON do not agree on which one counts of two."""
    found = dict(pairs)
    if len(found) < len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise ProblemError(422, "Not JSON", f"Names must differ; got {twice[:60]!r} twice.")
    return found


def _refuse_constant(name: str) -> None:
    raise ProblemError(422, "Not JSON", f"Numbers must be finite; got {name}.")


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


def _refuse_text(document: Any) -> None:
    text = json.dumps(document, ensure_ascii=False)
    try:
        text.encode()
    except UnicodeEncodeError as error:
        found = ascii(text[error.start])
        raise ProblemError(422, "Not Unicode", f"Text must be Unicode; got {found}.") from None
    if NUL.search(text):
        raise ProblemError(422, "Not text", "Text must be without NUL; got \\u0000.")


def _too_deep() -> ProblemError:
    return ProblemError(
        422, "Nested too deeply", f"At most {DEPTH} levels are taken; more came."
    )
