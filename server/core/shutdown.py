"""Know that the server is told to stop before it waits for its connections to end."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def on_shutdown(tell: Callable[[], object]) -> Iterator[None]:
    """Call `tell` when a signal to stop comes, then whoever listened before."""
    if current_thread() is not main_thread():  # Signals do not come here.
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}

    def heard(number: int, frame: FrameType | None) -> Any:
        tell()
        listener = before[signal.Signals(number)]
        if callable(listener):
            listener(number, frame)

    for number in SIGNALS:
        signal.signal(number, heard)
    try:
        yield
    finally:
        for number, listener in before.items():
            if signal.getsignal(number) is heard:
                signal.signal(number, listener)
