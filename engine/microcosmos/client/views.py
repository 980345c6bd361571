"""Where a run is watched: a terminal, a notebook, or a file of plain lines."""

import sys
import time
from typing import Any, Protocol, Self

from . import formatting
from .polling import Standing

SELDOM = 30.0
"""Seconds between two plain lines, unless something changes."""


class View(Protocol):
    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    def show(self, standing: Standing) -> None: ...


def fitting() -> View:
    """The view for where this runs."""
    if in_notebook():
        from .notebook import Notebook

        return Notebook()
    if sys.stdout.isatty():
        from .terminal import Terminal

        return Terminal()
    return Lines()


def in_notebook() -> bool:
    """Whether a notebook shows what is displayed; IPython is asked only where it is loaded."""
    loaded: Any = sys.modules.get("IPython")
    shell = loaded.get_ipython() if loaded else None
    return shell is not None and hasattr(shell, "kernel")


class Lines:
    """A line when the state changes, and every half minute or tenth of the way."""

    def __init__(self) -> None:
        self.told: tuple[Any, ...] = ()
        self.at = float("-inf")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def show(self, standing: Standing) -> None:
        record = standing.record
        place = (record["status"], int(10 * record["progress"]), standing.trouble)
        if place == self.told and time.monotonic() - self.at < SELDOM:
            return
        self.told, self.at = place, time.monotonic()
        print(line(standing), flush=True)


def line(standing: Standing) -> str:
    """How a run stands, on one line."""
    record = standing.record
    done = f"{record['generation']}/{record['generations']} {record.get('unit', 'generations')}"
    figures = [f"{name} {value}" for name, value in formatting.figures(record)]
    parts = [
        formatting.titled(record),
        formatting.standing(record),
        done,
        *figures,
        formatting.pace(record),
    ]
    return "  ".join(filter(None, [*parts, standing.trouble]))
