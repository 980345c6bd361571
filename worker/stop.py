"""The wish of the outside that this process stops, noted by a signal handler.

A plain flag: a lock, as an Event has one, could be held by the very code that the signal
interrupts.
"""

import signal
from collections.abc import Callable
from types import FrameType

_requested = False


def requested() -> bool:
    return _requested


def listen(then: Callable[[], None] = lambda: None, *, interrupt: bool = False) -> None:
    """From now on SIGTERM is a wish; Ctrl-C too, or else the business of whoever started us."""

    def note(signum: int, frame: FrameType | None) -> None:
        global _requested
        _requested = True
        then()

    signal.signal(signal.SIGTERM, note)
    signal.signal(signal.SIGINT, note if interrupt else signal.SIG_IGN)
