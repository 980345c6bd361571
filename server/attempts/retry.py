"""Retry database calls of an attempt while the database is away."""

import logging
import time
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from sqlalchemy.exc import OperationalError

RETRY_SECONDS = 1.0

F = TypeVar("F", bound=Callable[..., Any])
log = logging.getLogger(__name__)


def retried(method: F) -> F:
    """Retry a method for `outage_seconds` of its attempt, unless its worker must stop."""

    @wraps(method)
    def repeat(attempt: Any, *args: Any, **kwargs: Any) -> Any:
        deadline = time.monotonic() + attempt.outage_seconds
        while True:
            try:
                return method(attempt, *args, **kwargs)
            except OperationalError as error:
                if time.monotonic() >= deadline or attempt.stop_requested():
                    raise
                log.warning("Waiting for the database: %s", error)
                time.sleep(RETRY_SECONDS)

    return cast(F, repeat)
