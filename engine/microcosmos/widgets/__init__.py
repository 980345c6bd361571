"""Widgets for notebooks: the map of an archive, and a player of creatures.

They need `pip install "microcosmos[notebook]"`, which is loaded with the first of them.
"""

from importlib import import_module
from typing import Any

_HOME = {"ArchiveMap": "archive_map", "Player": "player"}

__all__ = [*_HOME]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
