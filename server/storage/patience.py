"""Patience: try again, with growing pauses, while the store does not answer."""

import logging
import time
from collections.abc import Callable
from typing import TypeVar

from ..core.errors import StoreUnavailable

FIRST_PAUSE, LONGEST_PAUSE = 0.2, 10.0

T = TypeVar("T")
log = logging.getLogger(__name__)


def patiently(action: Callable[[], T], seconds: float, stopped: Callable[[], bool]) -> T:
    """Return the result of an action; try again for some seconds, or until it is to stop."""
    deadline, pause = time.monotonic() + seconds, FIRST_PAUSE
    while True:
        try:
            return action()
        except StoreUnavailable as error:
            if time.monotonic() + pause > deadline or stopped():
                raise
            log.warning("Waiting for the store: %s", error)
        time.sleep(pause)
        pause = min(2 * pause, LONGEST_PAUSE)
