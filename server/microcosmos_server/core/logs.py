"""Logs of a process: lines of plain text or JSON, with fields, and without secrets."""

import json
import logging
import os
import re
from collections.abc import Iterable
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any
from urllib.parse import urlsplit
from uuid import uuid4

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ..settings import Settings
from . import logs

FIELDS = ("request", "run", "attempt", "worker")
QUIET = ("jax", "botocore", "aiobotocore", "s3fs", "httpx", "httpcore")
"""Library loggers that are too verbose."""
PATTERNS = (
    (re.compile(r"(?<=://)[^/\s@\"']*:[^/\s@\"']*(?=@)"), "…"),
    (re.compile(r"\b(mc_[\w-]{6})[\w-]+"), r"\1…"),
    (re.compile(r"\b(shares/[\w-]{4})[\w-]+"), r"\1…"),
    (re.compile(r"(?i)([?&]token=|\bbearer |\bcookie: ?)[^&\s\"']+"), r"\1…"),
)
"""Passwords in URLs; secrets of tokens and names of shares, except their first characters; and
any value that a client sends as a token or cookie."""

_process: dict[str, Any] = {}
_of_request: ContextVar[dict[str, Any] | None] = ContextVar("fields", default=None)


def bind(**fields: Any) -> None:
    """Set fields of all later lines of this process; None removes one."""
    _process.update(fields)


def bind_request(**fields: Any) -> None:
    """Set fields of the lines that this request causes."""
    _of_request.set(fields)


def request_id() -> str | None:
    return (_of_request.get() or {}).get("request")


def set_up(settings: Settings) -> None:
    """Log to standard error from now on."""
    secrets = _secrets(settings)
    handler = logging.StreamHandler()
    handler.setFormatter(Json(secrets) if settings.log_format == "json" else Plain(secrets))
    # A handler that a library installed would write each line again, with its secrets.
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.captureWarnings(True)
    for name in QUIET:
        logging.getLogger(name).setLevel(logging.WARNING)


class Plain(logging.Formatter):
    """`2026-01-31 12:00:00,000 INFO microcosmos_server.app: text run=…`."""

    def __init__(self, secrets: Iterable[str] = ()):
        super().__init__("%(asctime)s %(levelname)s %(name)s: %(message)s")
        self.secrets = tuple(secrets)

    def formatMessage(self, record: logging.LogRecord) -> str:
        fields = " ".join(f"{name}={value}" for name, value in _fields(record).items())
        return f"{super().formatMessage(record)} {fields}".rstrip()

    def format(self, record: logging.LogRecord) -> str:
        return redacted(super().format(record), self.secrets)


class Json(logging.Formatter):
    """One object in a line: `at`, `level`, `logger`, `message`, the fields, `traceback`."""

    def __init__(self, secrets: Iterable[str] = ()):
        super().__init__()
        self.secrets = tuple(secrets)

    def format(self, record: logging.LogRecord) -> str:
        line = {
            "at": datetime.fromtimestamp(record.created, UTC).isoformat(),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
            **_fields(record),
        }
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)
        texts = {
            name: redacted(value, self.secrets) if isinstance(value, str) else value
            for name, value in line.items()
        }
        return json.dumps(texts, ensure_ascii=False)


def redacted(text: str, secrets: Iterable[str]) -> str:
    """Return a text without known secrets, and without strings that look like secrets."""
    for secret in secrets:
        text = text.replace(secret, "…")
    for pattern, shown in PATTERNS:
        text = pattern.sub(shown, text)
    return text


def _fields(record: logging.LogRecord) -> dict[str, Any]:
    given = {name: getattr(record, name, None) for name in FIELDS}
    bound = _process | (_of_request.get() or {})
    found = {name: given[name] or bound.get(name) for name in FIELDS}
    return {name: value for name, value in found.items() if value is not None}


def _secrets(settings: Settings) -> list[str]:
    """Return the secrets that this process knows, the longest first."""
    found = [
        *(one.get_secret_value() for one in (settings.token, settings.webhook_url) if one),
        *(urlsplit(url).password for url in (settings.redis_url, settings.database_url)),
        *(os.environ.get(name) for name in ("AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN")),
    ]
    return sorted(filter(None, found), key=len, reverse=True)


HEADER = "X-Request-ID"
GIVEN = re.compile(r"[\w.-]{1,64}", re.ASCII)
RUN = re.compile(r"/runs/([0-9a-f-]{36})(?:/|$)")


class RequestId:
    """Middleware: take the id of a proxy, or make one, and name the run of the path."""

    def __init__(self, app: ASGIApp):
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        given = Headers(scope=scope).get(HEADER, "")
        # The id of a client may hold anything, also the end of a line.
        name = given if GIVEN.fullmatch(given) else uuid4().hex[:16]
        run = RUN.search(scope["path"])
        logs.bind_request(request=name, run=run[1] if run else None)

        async def send_with_id(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message)[HEADER] = name
            await send(message)

        await self.app(scope, receive, send_with_id)
