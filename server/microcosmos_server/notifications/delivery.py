"""Deliver notifications: sign each and send it to the webhook, in a thread of the server.

Headers and signature are those of Standard Webhooks: HMAC-SHA256 over id, time and body.
"""

import asyncio
import hmac
import logging
import os
import socket
import ssl
import time
from base64 import b64decode, b64encode
from contextlib import AbstractContextManager
from datetime import datetime
from threading import Event
from typing import Annotated, Literal
from uuid import UUID

import httpx
from fastapi import APIRouter, Header

from ..core.schemas import Wire
from ..services.periodic import repeating
from ..services.services import Services
from ..settings import WEBHOOK_PREFIX, Settings
from ..tables import Notification, Status
from . import outbox


class RunNotice(Wire):
    """A run as it was when it ended or paused."""

    run: UUID
    name: str | None
    experiment: str
    status: Status
    generation: int
    generations: int
    """Number of generations at the end."""
    attempt: int
    sweep: UUID | None
    reason: str | None
    """The error of a failed run, or the warning of a paused one."""
    url: str | None
    """Page of the run; null without `MICROCOSMOS_PUBLIC_URL`."""


class RunEvent(Wire):
    """The event that the webhook gets when a run ends, fails or pauses until a person acts."""

    type: Literal["run.finished", "run.failed", "run.cancelled", "run.paused"]
    timestamp: datetime
    """When the run reached the state, by the clock of the database."""
    data: RunNotice


# One thread sends them one after another, so a slow receiver holds up the others.
TIMEOUT = 5.0
"""Seconds that a receiver has to answer, once its name is known."""


class NotDelivered(Exception):
    """The receiver did not accept a notification; the message names no part of its address."""


def body_of(settings: Settings, one: Notification) -> bytes:
    """Return the body, the same at each try."""
    page = f"{settings.public_url}/runs/{one.run_id}"
    notice = RunNotice(**one.data, run=one.run_id, url=page if settings.public_url else None)
    event = {"type": one.kind, "timestamp": one.created_at, "data": notice}
    return RunEvent.model_validate(event).model_dump_json().encode()


def signed(secret: str, name: str, moment: int, body: bytes) -> dict[str, str]:
    """Return the headers of a body; `name` is the id of the event."""
    key = b64decode(secret.removeprefix(WEBHOOK_PREFIX))
    digest = hmac.digest(key, f"{name}.{moment}.".encode() + body, "sha256")
    return {
        "webhook-id": name,
        "webhook-timestamp": str(moment),
        "webhook-signature": f"v1,{b64encode(digest).decode()}",
    }


def send(settings: Settings, name: str, body: bytes) -> None:
    """Post a signed body; raise `NotDelivered` unless the receiver answers 2xx.

    Redirects are not followed: they could lead to another host, even one behind the firewall.
    """
    assert settings.webhook_url is not None
    assert settings.webhook_secret is not None
    headers = {"Content-Type": "application/json", "User-Agent": "microcosmos"}
    secret = settings.webhook_secret.get_secret_value()
    headers |= signed(secret, name, int(time.time()), body)
    try:
        status = asyncio.run(_posted(settings.webhook_url.get_secret_value(), headers, body))
    except TimeoutError:
        raise NotDelivered(f"it has not answered within {TIMEOUT:g} s") from None
    except (httpx.HTTPError, httpx.InvalidURL) as error:
        raise NotDelivered(_reason(error)) from None
    if 300 <= status < 400:
        raise NotDelivered(f"it answers {status}, and redirects are not followed")
    if not 200 <= status < 300:
        raise NotDelivered(f"it answers {status}")


async def _posted(url: str, headers: dict[str, str], body: bytes) -> int:
    # The certificates of this machine, among which may be those of a lab.
    trusted = ssl.create_default_context()
    # The client's own timeouts hold for each piece: a receiver could send a byte a second.
    async with (
        asyncio.timeout(TIMEOUT),
        httpx.AsyncClient(timeout=None, trust_env=False, verify=trusted) as client,
        client.stream("POST", url, headers=headers, content=body) as answer,
    ):
        return answer.status_code


def _reason(error: BaseException) -> str:
    """Return the cause of an error of the network without any part of the address."""
    cause: BaseException | None = error
    while cause:
        if isinstance(cause, ssl.SSLCertVerificationError):
            return "its certificate is not valid"
        if isinstance(cause, socket.gaierror):
            return "its name is not known"
        if isinstance(cause, OSError) and cause.errno and not isinstance(cause, ssl.SSLError):
            return os.strerror(cause.errno)
        cause = cause.__cause__ or cause.__context__
    return type(error).__name__


log = logging.getLogger(__name__)


def notifying(services: Services) -> AbstractContextManager[None]:
    """Send notifications now and every few seconds, in a thread, until the end of the block."""

    def send_all(ended: Event) -> None:
        while not ended.is_set() and send_next(services):
            pass

    return repeating("notifier", services.settings.reconcile_interval, send_all)


def send_next(services: Services) -> bool:
    """Send the next notification that is due; return whether another one may follow at once."""
    one = outbox.take(services)
    if one is None:
        return False
    if services.settings.webhook_url is None:
        outbox.settle(services, one, None)
        return True
    try:
        send(services.settings, str(one.id), body_of(services.settings, one))
    except NotDelivered as error:
        log.warning(
            "The webhook was not told `%s` of run %s at try %s: %s",
            *(one.kind, one.run_id, one.tries, error),
        )
        outbox.settle(services, one, outbox.FAILED)
        return False
    outbox.settle(services, one, outbox.DELIVERED)
    return True


webhooks = APIRouter(tags=["runs"])


@webhooks.post(
    "run",
    status_code=204,
    responses={"default": {"description": "Any other answer: it is sent again later"}},
)
def tell_run(
    event: RunEvent,
    webhook_id: Annotated[str, Header()],
    webhook_timestamp: Annotated[int, Header()],
    webhook_signature: Annotated[str, Header()],
) -> None:
    """Sent to `MICROCOSMOS_WEBHOOK_URL` until it is answered with a status of 2xx.

    `webhook-id` is the same at each try. `webhook-signature` is `v1,` and the HMAC-SHA256 of
    `webhook-id.webhook-timestamp.body` in base64.
    """
