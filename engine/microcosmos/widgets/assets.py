"""The JavaScript of the widgets, which `make web` builds from `web/src/widget`."""

from pathlib import Path
from typing import Any

from ..optional import require

FOLDER = Path(__file__).parent

anywidget: Any = require("anywidget", "microcosmos[notebook]")
traitlets: Any = require("traitlets", "microcosmos[notebook]")


def script() -> str:
    """Return the module of all widgets. Raise `FileNotFoundError` in a checkout without it."""
    return _built("widget.js")


def styles() -> str:
    """Return the styles of all widgets. Raise `FileNotFoundError` as `script` does."""
    return _built("widget.css")


def _built(name: str) -> str:
    path = FOLDER / name
    if not path.is_file():
        raise FileNotFoundError(f"`{name}` must be built first, in a checkout: make web")
    return path.read_text("utf-8")
