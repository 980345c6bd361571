"""End event streams when the token that opened them ends."""

import asyncio
import logging
from collections.abc import Callable, Collection
from uuid import UUID

from sqlalchemy.exc import SQLAlchemyError

from ..services.services import Services
from .tokens import live

CHECK_SECONDS = 1.0
"""Longest time that a stream outlives its token."""

log = logging.getLogger(__name__)


async def watch(
    services: Services,
    tokens: Callable[[], set[UUID]],
    end: Callable[[Collection[UUID]], None],
) -> None:
    """Call `end` with those of the `tokens` in use that have ended, until cancelled.

    One query each second serves all streams; without a stream there is none.
    """
    while True:
        await asyncio.sleep(CHECK_SECONDS)
        if used := tokens():
            try:
                valid = await asyncio.to_thread(_live, services, used)
            except SQLAlchemyError as error:
                log.warning("The tokens of event streams cannot be looked up: %s", error)
            else:
                end(used - valid)


def _live(services: Services, tokens: Collection[UUID]) -> set[UUID]:
    with services.sessions.read() as session:
        return live(session, tokens)
