"""What happens, live: server-sent events."""

from collections.abc import AsyncIterable, AsyncIterator
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from ..auth.authorize import Reader
from .fanout import Hub, Listener

router = APIRouter(prefix="/events", tags=["events"])


def hub(request: Request) -> Hub:
    return request.app.state.hub


HubDep = Annotated[Hub, Depends(hub)]


async def listener(hub: HubDep, principal: Reader) -> AsyncIterator[Listener]:
    """Listens before the answer begins: who then reads a state misses nothing after it."""
    with hub.listening(principal.token) as listener:
        yield listener


@router.get("", response_class=EventSourceResponse)
async def events(
    hub: HubDep,
    listener: Annotated[Listener, Depends(listener)],
    run: UUID | None = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """One stream of everything, or of one run; it goes on after Last-Event-ID."""
    async for event in hub.follow(listener, last_event_id, str(run) if run else None):
        yield event
