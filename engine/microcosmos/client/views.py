"""Watch a run in a terminal, in a notebook, or as plain lines."""

import sys
import time
from collections.abc import Iterator
from typing import Any, Protocol, Self

from . import formatting
from .polling import RunState

LINE_SECONDS = 30.0
"""Time between two plain lines, unless something changes."""


class View(Protocol):
    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    def show(self, state: RunState) -> None: ...


def watch(states: Iterator[RunState], what: str, view: View | None = None) -> str:
    """Show a run or a sweep, such as `Run ID`, until it ends; return its status.

    Ctrl-C ends only the watching; `KeyboardInterrupt` is passed on.
    """
    status = ""
    try:
        with view or choose() as shown:
            for state in states:
                shown.show(state)
                status = state.record["status"]
    except KeyboardInterrupt:
        again = f"microcosmos watch {what.rpartition(' ')[2][:8]}"
        print(f"{what} goes on without being watched; to watch it again: {again}", flush=True)
        raise
    return status


def choose() -> View:
    """Return the view for this environment."""
    if in_notebook():
        from .notebook import Notebook

        return Notebook()
    if sys.stdout.isatty():
        from .terminal import Terminal

        return Terminal()
    return Lines()


def in_notebook() -> bool:
    """Tell whether a notebook shows the output; IPython is not imported for that."""
    loaded: Any = sys.modules.get("IPython")
    shell = loaded.get_ipython() if loaded else None
    return shell is not None and hasattr(shell, "kernel")


class Lines:
    """Prints a line when the status changes, at each tenth of the way, and each half minute."""

    def __init__(self) -> None:
        self.shown: tuple[Any, ...] = ()
        self.at = float("-inf")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def show(self, state: RunState) -> None:
        record = state.record
        now = (record["status"], int(10 * record["progress"]), state.problem)
        if now == self.shown and time.monotonic() - self.at < LINE_SECONDS:
            return
        self.shown, self.at = now, time.monotonic()
        print(line(state), flush=True)


def line(state: RunState) -> str:
    """Describe a run on one line."""
    record = state.record
    parts = [
        formatting.title(record),
        formatting.status_and_reason(record),
        formatting.done(record),
        *(f"{name} {value}" for name, value in formatting.figures(record)),
        formatting.speed(record),
        state.problem,
    ]
    return "  ".join(filter(None, parts))
