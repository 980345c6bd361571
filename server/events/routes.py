"""The route of the event stream."""

from collections.abc import AsyncIterable, AsyncIterator
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.sse import EventSourceResponse, ServerSentEvent

from ..auth.authorize import Reader
from .fanout import Listener

router = APIRouter(prefix="/events", tags=["events"])


async def listener(request: Request, principal: Reader) -> AsyncIterator[Listener]:
    """Listen before the answer starts, so that a state read later misses no event."""
    with request.app.state.fanout.listening(principal.token) as listener:
        yield listener


@router.get("", response_class=EventSourceResponse)
async def events(
    request: Request,
    listener: Annotated[Listener, Depends(listener)],
    run: UUID | None = None,
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterable[ServerSentEvent]:
    """Stream all events, or those of one run. It goes on after `Last-Event-ID`."""
    fanout = request.app.state.fanout
    async for event in fanout.follow(listener, last_event_id, str(run) if run else None):
        yield event
