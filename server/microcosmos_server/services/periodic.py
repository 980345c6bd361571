"""Work that a server repeats in a thread of its own."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

from redis import RedisError
from sqlalchemy.exc import SQLAlchemyError

END_SECONDS = 15.0
"""Longest time for which a server that ends waits for its work, which a network may delay."""

log = logging.getLogger(__name__)


@contextmanager
def repeating(name: str, seconds: float, work: Callable[[Event], None]) -> Iterator[None]:
    """Do the work now and every few seconds, until the end of the block.

    The work gets an event that is set at the end. Whatever it raises is logged, and it is done
    again: without its thread lost runs would stay lost, and nobody would be told.
    """
    ended = Event()

    def repeat() -> None:
        while True:
            try:
                work(ended)
            except (RedisError, SQLAlchemyError) as error:
                log.warning("the %s will try again: %s", name, error)
            except Exception:
                log.exception("the %s will try again", name)
            if ended.wait(seconds):
                return

    thread = Thread(target=repeat, name=name, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join(END_SECONDS)
