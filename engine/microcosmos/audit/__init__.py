"""Checks, audits and measurements of one creature.

Names are loaded when they are first used.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "Check": "reproducibility",
    "check": "reproducibility",
    "audit": "physics",
    "measurement": "remeasure",
    "gradient": "derivatives",
    "gradient_health": "derivatives",
}

__all__ = [*_HOME]  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
