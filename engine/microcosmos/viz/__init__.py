"""Drawing: replays, films, figures for print, networks.

Names are loaded when they are first used.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "record": "replay",
    "Replay": "replay_file",
    "ReplayError": "replay_file",
    "read_replay": "replay_file",
    "frame": "raster",
    "gif": "film",
    "mp4": "film",
    "export": "files",
    "show": "notebook",
    "filmed": "notebook",
}

__all__ = [*_HOME]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
