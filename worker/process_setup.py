"""Set up a process of a worker: signals that request it to stop."""

import signal
from collections.abc import Callable
from types import FrameType

# Not an Event: the code that the signal interrupts might hold its lock.
_stop_requested = False


def stop_requested() -> bool:
    return _stop_requested


def handle_signals(then: Callable[[], None] = lambda: None, *, interrupt: bool = False) -> None:
    """Note SIGTERM as a request to stop. Note SIGINT if `interrupt`, else ignore it."""

    def note(signum: int, frame: FrameType | None) -> None:
        global _stop_requested
        _stop_requested = True
        then()

    signal.signal(signal.SIGTERM, note)
    signal.signal(signal.SIGINT, note if interrupt else signal.SIG_IGN)
