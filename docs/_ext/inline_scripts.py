"""Warn of inline scripts, which the server's security headers forbid."""

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.util import logging

INLINE = re.compile(r"<script(?![^>]*\bsrc=)[^>]*>\s*\S")

logger = logging.getLogger(__name__)


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("build-finished", warn)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def warn(app: Sphinx, failure: Exception | None) -> None:
    if failure is None and app.builder.format == "html":
        for page in sorted(Path(app.outdir).rglob("*.html")):
            if INLINE.search(page.read_text()):
                logger.warning("%s has an inline script", page.relative_to(app.outdir))
