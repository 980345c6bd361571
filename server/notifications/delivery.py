"""Delivery: sign a notification and send it to the webhook.

Headers and signature are those of Standard Webhooks: HMAC-SHA256 over id, time and body.
"""

import hmac
import ssl
import time
from base64 import b64decode, b64encode
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from urllib.parse import urlsplit

from ..settings import WEBHOOK_PREFIX, Settings
from ..tables import Notification
from .schemas import RunEvent, RunNotice

TIMEOUT = 5.0
"""Seconds that a receiver has to answer."""


class NotDelivered(Exception):
    """The receiver did not accept a notification; the message names no part of its address."""


def body_of(settings: Settings, one: Notification) -> bytes:
    """Return the body, the same at each try."""
    page = f"{settings.public_url.rstrip('/')}/runs/{one.run_id}"
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
    address = urlsplit(settings.webhook_url.get_secret_value())
    host, port = address.hostname or "", address.port
    connection = (
        HTTPSConnection(host, port, timeout=TIMEOUT, context=ssl.create_default_context())
        if address.scheme == "https"
        else HTTPConnection(host, port, timeout=TIMEOUT)
    )
    query = f"?{address.query}" if address.query else ""
    try:
        connection.request("POST", f"{address.path or '/'}{query}", body, headers)
        status = connection.getresponse().status
    except (OSError, HTTPException) as error:
        raise NotDelivered(f"{type(error).__name__}: {error}") from None
    finally:
        connection.close()
    if 300 <= status < 400:
        raise NotDelivered(f"it answers {status}, and redirects are not followed")
    if not 200 <= status < 300:
        raise NotDelivered(f"it answers {status}")
