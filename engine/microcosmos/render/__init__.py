"""What people look at: replays, pictures, films, figures, and checks of what was recorded.

Names are loaded when they are first used: reading replays and drawing them needs no JAX.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "Check": "checking",
    "check": "checking",
    "audit": "auditing",
    "measurement": "measuring",
    "gradient": "derivatives",
    "gradient_health": "derivatives",
    "record": "replay",
    "Replay": "reading",
    "ReplayError": "reading",
    "read_replay": "reading",
    "frame": "frames",
    "gif": "movie",
    "mp4": "movie",
    "export": "files",
    "show": "inline",
    "filmed": "inline",
}

__all__ = [*_HOME]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
