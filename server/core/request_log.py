"""Log requests without query parameters, and without the names of shares in paths."""

import logging
import re

SLUG = re.compile(r"(?<=/s/)[^/]+|(?<=/shares/)[^/]+")
SLUG_PREVIEW = 4
"""Characters of a slug in the log, by which requests for the same share are recognised."""


def install() -> None:
    """Have uvicorn log requests so from now on."""
    logging.getLogger("uvicorn.access").addFilter(_shorten)


def _shorten(record: logging.LogRecord) -> bool:
    if isinstance(record.args, tuple):
        record.args = tuple(map(_redacted, record.args))
    return True


def _redacted(argument: object) -> object:
    if not isinstance(argument, str):
        return argument
    path = argument.partition("?")[0]
    return SLUG.sub(lambda slug: f"{slug[0][:SLUG_PREVIEW]}…", path)
