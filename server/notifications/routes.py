"""The request that the webhook receives, for the OpenAPI document."""

from typing import Annotated

from fastapi import APIRouter, Header

from .schemas import RunEvent

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
