"""The log of requests names no share: whoever knows its name may see what was shared."""

import logging
import re

SLUG = re.compile(r"(?<=/s/)[^/?]+|(?<=/shares/)[^/?]+|(?<=[?&]cursor=)[^&]+")
KEPT = 4
"""Characters by which requests for the same share can still be told."""


def discreet() -> None:
    """Have uvicorn log requests so from now on."""
    logging.getLogger("uvicorn.access").addFilter(_shorten)


def _shorten(record: logging.LogRecord) -> bool:
    if isinstance(record.args, tuple):
        record.args = tuple(map(_without_slug, record.args))
    return True


def _without_slug(said: object) -> object:
    return SLUG.sub(lambda slug: f"{slug[0][:KEPT]}…", said) if isinstance(said, str) else said
