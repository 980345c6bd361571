"""The widgets' module and styles and the page of a replay, which `make web` builds.

Other packages read the page too, so this needs no optional package.
"""

from pathlib import Path

FOLDER = Path(__file__).parent


def script() -> str:
    """Return the module of all widgets. Raise `FileNotFoundError` in a checkout without it."""
    return _built("widget.js")


def styles() -> str:
    """Return the styles of all widgets. Raise `FileNotFoundError` as `script` does."""
    return _built("widget.css")


def page() -> str:
    """Return the page of a replay, without its data. Raise `FileNotFoundError` as `script`."""
    return _built("widget.html")


def _built(name: str) -> str:
    path = FOLDER / name
    if not path.is_file():
        raise FileNotFoundError(f"`{name}` must be built first, in a checkout: make web")
    return path.read_text("utf-8")
