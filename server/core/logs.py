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

from ..settings import Settings

FIELDS = ("request", "run", "attempt", "worker")
QUIET = ("jax", "botocore", "aiobotocore", "s3fs")
"""Loggers of libraries that say more than they need to."""
PATTERNS = (
    (re.compile(r"(?<=://)[^/\s@\"']*:[^/\s@\"']*(?=@)"), "…"),
    (re.compile(r"\b(mc_[\w-]{6})[\w-]+"), r"\1…"),
    (re.compile(r"(?i)([?&]token=|\bbearer |\bcookie: ?)[^&\s\"']+"), r"\1…"),
)
"""Passwords in URLs; secrets of tokens, but for the characters that their table keeps; and what
clients send as one."""

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
    logging.basicConfig(level=logging.INFO, handlers=[handler], force=True)
    logging.captureWarnings(True)
    for name in QUIET:
        logging.getLogger(name).setLevel(logging.WARNING)


class Plain(logging.Formatter):
    """`2026-01-31 12:00:00,000 INFO server.app: text run=…`."""

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
    """Return a text without the known secrets and without what looks like one."""
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
        settings.token.get_secret_value() if settings.token else None,
        *(urlsplit(url).password for url in (settings.redis_url, settings.database_url)),
        *(os.environ.get(name) for name in ("AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN")),
    ]
    return sorted(filter(None, found), key=len, reverse=True)
