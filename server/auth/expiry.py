"""Event streams end when the token does with which they were opened."""

import asyncio
import logging
from collections.abc import Collection
from uuid import UUID

from sqlalchemy.exc import SQLAlchemyError

from ..events.fanout import Hub
from ..services.services import Services
from .tokens import live

EVERY = 1.0
"""Seconds for which a stream may outlive its token."""

log = logging.getLogger(__name__)


async def watch(hub: Hub, services: Services) -> None:
    """One question a second for all streams together, and none where nobody listens."""
    while not hub.closed:
        await asyncio.sleep(EVERY)
        if held := hub.tokens():
            try:
                good = await asyncio.to_thread(_live, services, held)
            except SQLAlchemyError as error:
                log.warning("no token can be looked up: %s", error)
            else:
                hub.end(held - good)


def _live(services: Services, tokens: Collection[UUID]) -> set[UUID]:
    with services.sessions.read() as session:
        return live(session, tokens)
