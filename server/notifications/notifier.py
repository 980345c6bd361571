"""The notifier: a thread of the server that sends notifications, so that no run waits."""

import logging
from contextlib import AbstractContextManager
from threading import Event

from ..services.periodic import repeating
from ..services.services import Services
from . import outbox
from .delivery import NotDelivered, body_of, send

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
