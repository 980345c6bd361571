"""Watch a run in a terminal, in a notebook, or as plain lines."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from . import formatting
from .polling import RunState

LINE_SECONDS = 30.0
"""Time between two plain lines, unless something changes."""

Show = Callable[[RunState], None]
View = AbstractContextManager[Show]


def watch(states: Iterator[RunState], what: str, view: View | None = None) -> str:
    """Show a run or a sweep, such as `Run ID`, until it ends; return its status.

    Ctrl-C ends only the watching; `KeyboardInterrupt` is passed on.
    """
    status = ""
    try:
        with view or choose()() as show:
            for state in states:
                show(state)
                status = state.record["status"]
    except KeyboardInterrupt:
        again = f"microcosmos watch {what.rpartition(' ')[2][:8]}"
        print(f"{what} goes on without being watched; to watch it again: {again}", flush=True)
        raise
    return status


def choose() -> Callable[[], View]:
    """Return the view for this environment."""
    if in_notebook():
        from .notebook import notebook

        return notebook
    if sys.stdout.isatty():
        from .terminal import terminal

        return terminal
    return lines


def in_notebook() -> bool:
    """Tell whether a notebook shows the output; IPython is not imported for that."""
    loaded: Any = sys.modules.get("IPython")
    shell = loaded.get_ipython() if loaded else None
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def lines() -> Iterator[Show]:
    """Print a line when the status changes, at each tenth of the way, and each half minute."""
    last: Any = None
    at = float("-inf")

    def show(state: RunState) -> None:
        nonlocal last, at
        record = state.record
        now = (record["status"], int(10 * record["progress"]), state.problem)
        if now != last or time.monotonic() - at >= LINE_SECONDS:
            last, at = now, time.monotonic()
            print(line(state), flush=True)

    yield show


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
