"""`python -m microcosmos_server.notifications`: send the webhook an invented event."""

import sys
from datetime import UTC, datetime
from uuid import UUID, uuid4

from ..settings import from_environment
from ..tables import FINISHED, Notification
from .delivery import NotDelivered, body_of, send

INVENTED = {"name": "a test of the webhook", "experiment": "quality-diversity", "sweep": None}
INVENTED |= {
    "status": FINISHED,
    "generation": 1,
    "generations": 1,
    "attempt": 1,
    "reason": None,
}


def main() -> None:
    """Print what the receiver answered; end with status 1 if it accepts nothing."""
    settings = from_environment()
    if settings.webhook_url is None:
        sys.exit("`MICROCOSMOS_WEBHOOK_URL` must be set, as the server has it.")
    one = Notification(
        run_id=UUID(int=0), kind="run.finished", data=INVENTED, created_at=datetime.now(UTC)
    )
    try:
        send(settings, str(uuid4()), body_of(settings, one))
    except NotDelivered as error:
        sys.exit(f"The webhook was not told: {error}.")
    print("The webhook accepted `run.finished` of an invented run.")


if __name__ == "__main__":
    main()
